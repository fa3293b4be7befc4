"""The choices above the comparison. They hide rows of the tables, curves of the charts, and charts and pictures of
other conditions."""

from html import escape

from .figures import percent_label


def html(results):
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
        f"<span>{words}:</span>{''.join(choices)}" for words, choices in groups if any(choices)) + "</div>"
