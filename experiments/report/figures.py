"""A figure: what it shows, or why it is left out."""

from dataclasses import dataclass
from html import escape

from .theme import svg_of


@dataclass(frozen=True)
class Figure:
    """`svg` is empty where `missing` says why there is none."""

    name: str
    title: str
    caption: str = ""
    svg: str = ""
    missing: str = ""

    def html(self):
        if self.missing:
            return (f'<p class="left-out" id="{self.name}"><b>{escape(self.title)}.</b> '
                    f"Left out: {escape(self.missing)}</p>")
        return (f'<figure id="{self.name}"><h4>{escape(self.title)}</h4>'
                f'<div class="plot" role="img" aria-label="{escape(self.title)}. {escape(self.caption)}">'
                f"{self.svg}</div><figcaption>{escape(self.caption)}</figcaption></figure>")


def drawn(name, title, caption, figure):
    return Figure(name, title, caption, svg_of(figure, name))


def left_out(name, title, why):
    return Figure(name, title, missing=why)


def group(figures):
    """Figures side by side where there is room, then a sentence for each one left out."""
    present = "".join(figure.html() for figure in figures if not figure.missing)
    absent = "".join(figure.html() for figure in figures if figure.missing)
    return (f'<div class="figures">{present}</div>' if present else "") + absent


def percent_label(rate):
    """A rate as axes and tables show it: 16.7, not 16.66; 30, not 30.0."""
    return f"{100.0 * rate:.1f}".rstrip("0").rstrip(".")
