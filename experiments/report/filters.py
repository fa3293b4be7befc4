"""The choices above the comparison. They hide rows of the tables, curves of the charts, and charts and pictures of
other conditions."""

from html import escape

from .conditions import whole
from .summaries import percent_label


def _explained(results, conditions):
    """What the conditions are, beside the choice of one."""
    told = [f"<b>{escape(name)}</b>: {escape(whole(conditions, name))}." for name in results.conditions
            if whole(conditions, name)]
    return f'<p class="note conditions">{" ".join(told)}</p>' if told else ""


def html(results, conditions):
    def choice(key, title, values, show):
        if len(values) < 2:
            return ""
        options = "".join(f'<option value="{escape(str(value))}">{escape(show(value))}</option>' for value in values)
        return f'<label>{title} <select data-filter="{key}"><option value="">all</option>{options}</select></label>'

    everywhere = [choice("condition", "Condition", results.conditions, lambda name: name or "none named"),
                  choice("method", "Method", [sample.label for sample in results.samples], str)]
    in_tables = [choice("rate", "False positives", results.rates, lambda rate: f"{percent_label(rate)} %"),
                 choice("range", "Range", results.ranges, lambda value: f"{value:g} m")]
    groups = [("Show in tables, charts and pictures", everywhere), ("in tables", in_tables)]
    return '<div class="controls" id="filters">' + "".join(
        f"<span>{words}:</span>{''.join(choices)}" for words, choices in groups if any(choices)) + "</div>" + _explained(results, conditions)
