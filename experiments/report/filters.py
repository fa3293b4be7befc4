"""The choices at the top of the page, which hide rows of its tables and figures of other conditions."""

from html import escape

from .figures import percent_label


def html(results):
    def choice(key, title, values, show):
        if len(values) < 2:
            return ""
        options = "".join(f'<option value="{escape(str(value))}">{escape(show(value))}</option>' for value in values)
        return f'<label>{title} <select data-filter="{key}"><option value="">all</option>{options}</select></label>'

    choices = [choice("condition", "Condition", results.conditions, lambda name: name or "none named"),
               choice("rate", "False positives", results.rates, lambda rate: f"{percent_label(rate)} %"),
               choice("range", "Range", results.ranges, lambda value: f"{value:g} m"),
               choice("method", "Method", [sample.label for sample in results.samples], str)]
    return f'<div class="controls" id="filters"><span>Rows of all tables by method:</span>{"".join(choices)}</div>'
