"""HTML tables: sortable by their headers, scrolled sideways where the screen is narrow."""

import math
from dataclasses import dataclass, field
from html import escape

from .theme import METHOD_COLORS


@dataclass(frozen=True)
class Column:
    title: str
    kind: str = "number"  # or "text"
    hint: str = ""  # stands small below the title


@dataclass(frozen=True)
class Cell:
    """`value` is what sorting goes by, `extra` stands small beside the text."""

    text: str
    value: object = None
    extra: str = ""
    attributes: dict = field(default_factory=dict)
    color: int | None = None  # of a method's swatch


def text(value):
    return Cell(value, value)


def method_cell(methods, method, label):
    return Cell(label, label, color=methods.index(method) % METHOD_COLORS)


def _range(interval, show):
    """Empty where both ends read the same: that says nothing."""
    if not interval or show(interval[0]) == show(interval[1]):
        return ""
    return f"{show(interval[0])}–{show(interval[1])}"


def percent(share, digits=1, interval=None, **attributes):
    """A share in [0, 1] as per cent; None as unknown."""
    if share is None:
        return Cell("–")

    def show(value):
        return f"{100.0 * value:.{digits}f}"
    return Cell(show(share), float(share), _range(interval, show), attributes)


def metres(value, **attributes):
    """None as unknown."""
    return Cell("–") if value is None else Cell(f"{value:.2f}", float(value), attributes=attributes)


def degrees(value_rad, **attributes):
    """None as unknown; sorts by radians."""
    return Cell("–") if value_rad is None else Cell(f"{math.degrees(value_rad):.2f}", float(value_rad),
                                                    attributes=attributes)


def milliseconds(value, interval=None, limit_ms=math.inf, **attributes):
    """Named a limit where the time limit ended it: what took longer is unknown."""
    def show(number):
        return f"{number:.2f}" if number < 1000 else f"{number:.0f}"
    extra = "limit" if value >= limit_ms else _range(interval, show)
    return Cell(show(value), float(value), extra, attributes)


def _cell_html(cell, column, tag):
    attributes = "".join(f' data-{key}="{escape(str(value))}"' for key, value in cell.attributes.items())
    if cell.value is not None:
        attributes += f' data-value="{escape(repr(cell.value) if isinstance(cell.value, float) else str(cell.value))}"'
    extra = f' <small>{escape(cell.extra)}</small>' if cell.extra else ""
    name = ' class="number"' if column.kind == "number" else ""
    scope = ' scope="row"' if tag == "th" else ""
    swatch = "" if cell.color is None else f'<span class="swatch" style="background:var(--m{cell.color})"></span>'
    return f"<{tag}{scope}{name}{attributes}>{swatch}{escape(cell.text)}{extra}</{tag}>"


def _row_html(row, columns, name, attributes):
    marks = f' class="{name}"' if name else ""
    marks += "".join(f' data-{key}="{escape(str(value))}"' for key, value in attributes.items())
    cells = "".join(_cell_html(cell, column, "td" if j else "th") for j, (cell, column) in enumerate(zip(row, columns)))
    return f"<tr{marks}>{cells}</tr>"


def _table_html(name, caption, columns, bodies, note):
    head = "".join(f'<th scope="col"{" class=number" if column.kind == "number" else ""} aria-sort="none">'
                   f'<button type="button">{escape(column.title)}</button>'
                   + (f'<small class="hint">{escape(column.hint)}</small>' if column.hint else "") + "</th>"
                   for column in columns)
    note = f'<p class="note">{escape(note)}</p>' if note else ""
    title = f'<h4 id="{name}-title">{escape(caption)}</h4>' if caption else ""
    label = f'aria-labelledby="{name}-title"' if caption else f'aria-label="{name}"'
    bodies = "".join(f"<tbody>{body}</tbody>" for body in bodies)
    return (f'<div class="table" id="{name}">{title}<div class="scroll" tabindex="0" role="region" {label}>'
            f'<table class="sortable" {label}><thead><tr>{head}</tr></thead>{bodies}</table></div>{note}</div>')


def table(name, caption, columns, rows, published_rows=(), row_attributes=None, note=""):
    """`caption` is empty where the table stands below an experiment's title. `published_rows`: numbers of the rows
    that a paper prints, or how many of the first ones."""
    if isinstance(published_rows, int):
        published_rows = range(published_rows)
    published_rows = set(published_rows)
    body = "".join(_row_html(row, columns, "published" if i in published_rows else "",
                             row_attributes[i] if row_attributes else {}) for i, row in enumerate(rows))
    return _table_html(name, caption, columns, [body], note)


def block_table(name, caption, columns, blocks, note=""):
    """Blocks of rows, each (title, rows, attributes of the rows), that are sorted each for itself."""
    bodies = []
    for title, rows, row_attributes in blocks:
        head = f'<tr class="block"><th colspan="{len(columns)}" scope="rowgroup">{escape(title)}</th></tr>'
        bodies.append(head + "".join(_row_html(row, columns, "", attributes)
                                     for row, attributes in zip(rows, row_attributes)))
    return _table_html(name, caption, columns, bodies, note)
