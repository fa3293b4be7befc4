"""HTML tables: sortable by their headers, scrolled sideways where the screen is narrow. A table is described by its
columns: each makes a cell of a row."""

import math
from dataclasses import dataclass, field
from html import escape
from typing import Callable

from . import summaries
from .theme import METHOD_COLORS


@dataclass(frozen=True)
class Cell:
    """`value` is what sorting goes by, `extra` stands small beside the text."""

    text: str
    value: object = None
    extra: str = ""
    attributes: dict = field(default_factory=dict)
    color: int | None = None  # of a method's swatch


@dataclass(frozen=True)
class Column:
    title: str
    cell: Callable  # of a row
    kind: str = "number"  # or "text"
    hint: str = ""  # stands small below the title


# Cells of one value each; None is unknown.


def _range(interval, show):
    """Empty where both ends read the same: that says nothing."""
    if not interval or show(interval[0]) == show(interval[1]):
        return ""
    return f"{show(interval[0])}–{show(interval[1])}"


def _cell(value, show, interval=None, extra="", **attributes):
    if value is None:
        return Cell(summaries.UNKNOWN)
    return Cell(show(value), value if isinstance(value, (str, int)) else float(value), extra or _range(interval, show), attributes)


def text(value, **options):
    return _cell(value, str, **options)


def count(value, **options):
    return text(value, **options)


def fixed(value, digits=1, **options):
    return _cell(value, lambda number: f"{number:.{digits}f}", **options)


def short(value, digits=3, **options):
    """As few digits as tell it."""
    return _cell(value, lambda number: f"{number:.{digits}g}", **options)


def percent(share, digits=1, **options):
    """A share in [0, 1] as per cent."""
    return _cell(share, lambda value: summaries.percent(value, digits), **options)


def degrees(value_rad, **options):
    """Sorts by radians."""
    return _cell(value_rad, lambda value: f"{math.degrees(value):.2f}", **options)


def milliseconds(value, limit_ms=math.inf, **options):
    """Named a limit where the time limit ended it: what took longer is unknown."""
    return _cell(value, lambda number: f"{number:.2f}" if number < 1000 else f"{number:.0f}",
                 extra="limit" if value is not None and value >= limit_ms else "", **options)


def column(title, show, of, hint="", **options):
    """A column of what `show` makes of row[of] or of(row); of the options those that are callable are of the row, too."""
    def cell(row):
        of_row = {key: option(row) if callable(option) else option for key, option in options.items()}
        return show(of(row), **of_row) if callable(of) else show(row.get(of), measure=of, **of_row)
    return Column(title, cell, "text" if show is text else "number", hint)


def method_cell(results, method, label=None):
    return Cell(label or method, label or method, color=results.methods.index(method) % METHOD_COLORS)


def method_column(results):
    """Of rows that are samples."""
    return Column("method", lambda sample: method_cell(results, sample.method, sample.label), "text")


def _attributes(values):
    return "".join(f' data-{key}="{escape(str(value))}"' for key, value in values.items())


def _cell_html(cell, of_column, tag):
    attributes = _attributes(cell.attributes)
    if cell.value is not None:
        attributes += f' data-value="{escape(repr(cell.value) if isinstance(cell.value, float) else str(cell.value))}"'
    extra = f' <small>{escape(cell.extra)}</small>' if cell.extra else ""
    name = ' class="number"' if of_column.kind == "number" else ""
    scope = ' scope="row"' if tag == "th" else ""
    swatch = "" if cell.color is None else f'<span class="swatch" style="background:var(--m{cell.color})"></span>'
    return f"<{tag}{scope}{name}{attributes}>{swatch}{escape(cell.text)}{extra}</{tag}>"


def table(name, columns, rows=(), blocks=(), caption="", note="", attributes=lambda row: {}, is_published=lambda row: False):
    """`rows`: what the columns make cells of. `blocks`, instead: pairs (title, rows), each sorted for itself.
    `caption` is empty where the table stands below an experiment's title. `is_published`: whether a paper prints the row."""
    def row_html(row):
        marks = ' class="published"' if is_published(row) else ""
        cells = "".join(_cell_html(of_column.cell(row), of_column, "td" if j else "th") for j, of_column in enumerate(columns))
        return f"<tr{marks}{_attributes(attributes(row))}>{cells}</tr>"

    bodies = ""
    for title, of_block in blocks or [("", rows)]:
        head = f'<tr class="block"><th colspan="{len(columns)}" scope="rowgroup">{escape(title)}</th></tr>' if title else ""
        bodies += f"<tbody>{head}{''.join(map(row_html, of_block))}</tbody>"
    head = "".join(f'<th scope="col"{" class=number" if one.kind == "number" else ""} aria-sort="none">'
                   f'<button type="button">{escape(one.title)}</button>'
                   + (f'<small class="hint">{escape(one.hint)}</small>' if one.hint else "") + "</th>" for one in columns)
    note = f'<p class="note">{escape(note)}</p>' if note else ""
    title = f'<h4 id="{name}-title">{escape(caption)}</h4>' if caption else ""
    label = f'aria-labelledby="{name}-title"' if caption else f'aria-label="{name}"'
    return (f'<div class="table" id="{name}">{title}<div class="scroll" tabindex="0" role="region" {label}>'
            f'<table class="sortable" {label}><thead><tr>{head}</tr></thead>{bodies}</table></div>{note}</div>')
