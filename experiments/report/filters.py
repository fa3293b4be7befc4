"""The choices above the comparison, which hide rows of its tables."""


def html(results):
    def choice(key, title, values, show):
        options = "".join(f'<option value="{value}">{show(value)}</option>' for value in values)
        return f'<label>{title} <select data-filter="{key}"><option value="">all</option>{options}</select></label>'

    rates = choice("rate", "False positives", results.rates, lambda rate: f"{100 * rate:.1f} %")
    ranges = choice("range", "Range", results.ranges, lambda value: f"{value:g} m")
    methods = choice("method", "Method", [sample.label for sample in results.samples], str)
    return f'<div class="controls" id="filters">{methods}{rates}{ranges}</div>'
