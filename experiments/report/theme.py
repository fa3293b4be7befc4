"""The look of the figures. They are drawn in stand-in colours that become CSS variables in the SVG, so that one
figure serves the light and the dark page."""

import io
import re

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402  (the backend has to be chosen first)

INK, MUTED, GRID, ACCENT, SURFACE = "#010201", "#010202", "#010203", "#010204", "#010205"
_VARIABLES = {INK: "--ink", MUTED: "--muted", GRID: "--grid", ACCENT: "--accent", SURFACE: "--surface"}
METHOD_COLOURS = 8  # --m0 ... --m7 of style.css
_DASHES = ("-", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
MARKERS = "osD^vPX*"

pyplot.rcParams.update({
    "svg.fonttype": "none", "font.size": 9, "font.family": "DejaVu Sans", "text.color": INK,
    "axes.edgecolor": MUTED, "axes.labelcolor": MUTED, "axes.linewidth": 0.7, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True, "grid.color": GRID,
    "grid.linewidth": 0.6, "xtick.color": MUTED, "ytick.color": MUTED, "xtick.major.size": 0,
    "ytick.major.size": 0, "xtick.minor.size": 0, "ytick.minor.size": 0, "legend.frameon": False,
    "legend.fontsize": 8, "lines.linewidth": 1.6, "lines.markersize": 4.5, "patch.linewidth": 0.8,
    "figure.facecolor": "none", "axes.facecolor": "none", "savefig.facecolor": "none"})


def method_colour(methods, method):
    """Stand-in of a method's colour, the same in every figure."""
    return f"#0103{methods.index(method) % METHOD_COLOURS:02x}"


def method_style(methods, method, variant=0):
    """Colour, marker and dashes: what colour cannot tell apart, the others do. `variant` counts the cone-set
    sizes of one method."""
    index = methods.index(method)
    return {"color": method_colour(methods, method), "marker": MARKERS[index % len(MARKERS)],
            "linestyle": _DASHES[(index // METHOD_COLOURS + variant) % len(_DASHES)]}


def logarithmic(axis):
    """Ticks at powers of ten, written out: 0.1, 1, 10."""
    axis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.set_minor_formatter(lambda value, _: "")


def new_figure(height=2.9, width=4.7):
    return pyplot.subplots(figsize=(width, height), layout="constrained")


def legend(axes):
    """Below the axes, where it hides nothing."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        height_in = axes.figure.get_size_inches()[1]
        axes.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, -0.5 / (height_in - 0.7)),
                    ncol=2 if max(map(len, labels)) < 30 else 1, handlelength=2.4, columnspacing=1.4)


def svg_of(figure, name):
    """The figure as an <svg> element whose ids begin with `name`."""
    with pyplot.rc_context({"svg.hashsalt": name}):
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    pyplot.close(figure)
    svg = stream.getvalue()
    svg = svg[svg.index("<svg"):]
    for stand_in, variable in _VARIABLES.items():
        svg = svg.replace(stand_in, f"var({variable})")
    svg = re.sub(r"#0103([0-9a-f]{2})", lambda found: f"var(--m{int(found[1], 16)})", svg)
    svg = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px", svg)
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.S)
    for kind in (r'id="', r'href="#', r"url\(#"):
        svg = re.sub(f"({kind})", rf"\g<1>{name}-", svg)
    svg = re.sub(r"<!--.*?-->\n? *", "", svg, flags=re.S)
    return re.sub(r'^<svg[^>]*?(viewBox="[^"]*")[^>]*>', r'<svg \1 aria-hidden="true" focusable="false">', svg)
