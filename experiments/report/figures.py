"""Figures on the page, and how rates stand on their axes."""

from html import escape

from .theme import svg_of


def drawn(name, caption, figure, title="", condition=""):
    """A figure with its caption; `title` where it does not stand alone below an experiment's, `condition` where it is
    of one of several."""
    head = f"<h4>{escape(title)}</h4>" if title else ""
    of_condition = f' data-condition="{escape(condition)}"' if condition else ""
    return (f'<figure id="{name}"{of_condition}>{head}<div class="plot" role="img" aria-label="{escape(title or name)}. '
            f'{escape(caption)}">{svg_of(figure, name)}</div><figcaption>{escape(caption)}</figcaption></figure>')


def group(figures):
    """Side by side where there is room."""
    return f'<div class="figures">{"".join(figures)}</div>' if figures else ""


def percent_label(rate):
    """A rate as axes and tables show it: 16.7, not 16.66; 30, not 30.0."""
    return f"{100.0 * rate:.1f}".rstrip("0").rstrip(".")


def in_condition(results):
    """What a caption adds where a figure takes one of several conditions."""
    return f" Condition {results.main_condition} alone." if len(results.conditions) > 1 else ""


def variants(samples):
    """For each sample, how many of the same method come before it."""
    seen = {}
    for sample in samples:
        seen[sample.method] = seen.get(sample.method, -1) + 1
        yield sample, seen[sample.method]


def name_of_set(nearest):
    return "all that is visible" if nearest is None else f"the {nearest} nearest cones"
