"""Figures on the page, and how rates stand on their axes."""

from html import escape

from .theme import method_style, svg_of


def drawn(name, caption, figure, title="", condition=""):
    """A figure with its caption; `title` where it does not stand alone below an experiment's, `condition` where it is
    of one of several."""
    head = f"<h4>{escape(title)}</h4>" if title else ""
    of_condition = f' data-condition="{escape(condition)}"' if condition else ""
    return (f'<figure id="{name}"{of_condition}>{head}<div class="plot" role="img" aria-label="{escape(title or name)}. '
            f'{escape(caption)}">{svg_of(figure, name)}</div><figcaption>{escape(caption)}</figcaption></figure>')


# The markers of theme.MARKERS as paths in a box from -5 to 5.
_MARKER_PATHS = {"o": "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0Z", "s": "M-4-4h8v8h-8Z", "D": "M0-5L5 0L0 5L-5 0Z",
                 "^": "M0-5L5 4H-5Z", "v": "M0 5L5-4H-5Z", "P": "M-1.6-5h3.2v3.4H5v3.2H1.6V5h-3.2V1.6H-5v-3.2h3.4Z",
                 "X": "M-5-3L-3-5L0-2L3-5L5-3L2 0L5 3L3 5L0 2L-3 5L-5 3L-2 0Z",
                 "*": "M0-5L1.2-1.6H4.8L1.9.6L3 4L0 1.9L-3 4L-1.9.6L-4.8-1.6H-1.2Z"}


def method_key(results, samples):
    """The legend of the methods' curves, once for all figures below it."""
    entries = []
    for sample, variant in variants(samples):
        style = method_style(results.methods, sample.method, variant)
        color = style["color"].partition(":")[2]
        dash = style["linestyle"]
        dashes = "" if dash == "-" else f' stroke-dasharray="{" ".join(f"{2 * part:g}" for part in dash[1])}"'
        entries.append(f'<span class="key"><svg viewBox="-15 -6 30 12" aria-hidden="true"><path d="M-15 0H15" '
                       f'stroke="var(--{color})" stroke-width="2"{dashes}/><path d="{_MARKER_PATHS[style["marker"]]}" '
                       f'fill="var(--{color})"/></svg>{escape(sample.label)}</span>')
    return f'<p class="method-key">{" ".join(entries)}</p>'


def group(figures, key=""):
    """Side by side where there is room, below a `key` that serves them all."""
    return f'{key}<div class="figures">{"".join(figures)}</div>' if figures else ""


def counts_of_points(results, samples):
    """How many scenes a point of a curve by rate has: n = 115 scenes a point."""
    counts = sorted({len(sample.at(rate)) for sample in samples for rate in results.rates} - {0})
    between = f"{counts[0]} to {counts[-1]}" if len(counts) > 1 else f"{counts[0]}" if counts else "0"
    return f"n = {between} scenes a point."


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
