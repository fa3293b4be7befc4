"""The look of the figures. They are drawn in stand-in colours that become CSS variables in the SVG, so that one
figure serves the light and the dark page; as pictures they have the colours of the light one."""

import contextlib
import io
import pkgutil
import re

import matplotlib
import matplotlib.colors
import numpy as np

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402  (the backend has to be chosen first)

# Names that matplotlib looks up when it draws: stand-ins for the page, which replaces them by CSS variables, and for
# pictures the values that the light page gives those variables.
_VARIABLES = ("ink", "muted", "grid", "accent", "surface") + tuple(f"m{i}" for i in range(8))
_STAND_INS = {variable: f"#0102{index:02x}" for index, variable in enumerate(_VARIABLES)}
_NAMES = matplotlib.colors.get_named_colors_mapping()


def _use(colors):
    for variable, color in colors.items():
        _NAMES[f"conelane:{variable}"] = color


_use(_STAND_INS)
INK, MUTED, GRID, ACCENT, SURFACE = (f"conelane:{variable}" for variable in _VARIABLES[:5])
METHOD_COLORS = 8  # --m0 ... --m7 of style.css
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


def method_color(methods, method):
    """A method's colour, the same in every figure."""
    return f"conelane:m{methods.index(method) % METHOD_COLORS}"


def method_style(methods, method, variant=0):
    """Colour, marker and dashes: what colour cannot tell apart, the others do. `variant` counts the cone-set
    sizes of one method."""
    index = methods.index(method)
    return {"gid": f"curve:{method}", "color": method_color(methods, method), "marker": MARKERS[index % len(MARKERS)],
            "linestyle": _DASHES[(index // METHOD_COLORS + variant) % len(_DASHES)]}


def series_style(index):
    """As method_style, for curves that are no methods."""
    return {"color": f"conelane:m{index % METHOD_COLORS}", "linestyle": _DASHES[index % len(_DASHES)]}


def logarithmic(axis):
    """Ticks at powers of ten, written out: 0.1, 1, 10."""
    axis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.set_minor_formatter(lambda value, _: "")


def percent_axis(axes):
    """Room for a marker at 100 %, and no tick above."""
    axes.set_ylim(top=102)
    bottom = axes.get_ylim()[0]
    axes.set_yticks([tick for tick in axes.get_yticks() if bottom <= tick <= 100])


LEADERS_TICKS = (0, 50, 80, 90, 95, 98, 100)


def leaders_axis(axes):
    """Per cent, stretched towards 100 so that the best can be told apart."""
    bottom = max(0.0, axes.get_ylim()[0])
    axes.set_yscale("function", functions=(lambda y: -np.log10(np.maximum(103.0 - np.asarray(y, float), 1e-3)),
                                           lambda y: 103.0 - 10.0 ** -np.asarray(y, float)))
    axes.set_ylim(bottom, 100.5)
    axes.set_yticks([tick for tick in LEADERS_TICKS if tick >= bottom])
    axes.set_yticks([], minor=True)


def new_figure(height=2.9, width=4.7):
    return pyplot.subplots(figsize=(width, height), layout="constrained")


def legend(axes):
    """Below the axes, where it hides nothing."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        height_in = axes.figure.get_size_inches()[1]
        axes.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, -0.5 / (height_in - 0.7)),
                    ncol=max(1, min(3, 60 // (6 + max(map(len, labels))))), handlelength=2.4, columnspacing=1.4)


_alone = False  # whether figures are pictures that stand alone


def method_legend(axes):
    """The legend of the methods' curves, in pictures alone: on the page one above the figures serves them all."""
    if _alone:
        legend(axes)


@contextlib.contextmanager
def picture_colors():
    """Figures made and saved within have the colours of the light page."""
    style = pkgutil.get_data(__package__, "style.css").decode("utf-8")
    light = dict(re.findall(r"--(\w+): (#[0-9a-f]{6})", style[:style.index("}")]))
    global _alone
    _use({variable: light[variable] for variable in _VARIABLES})
    _alone = True
    try:
        yield
    finally:
        _use(_STAND_INS)
        _alone = False


def png_of(figure, dpi=200):
    """The figure as a PNG file's bytes; the same figure gives the same bytes."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=dpi, facecolor=SURFACE, metadata={"Software": None})
    pyplot.close(figure)
    return stream.getvalue()


def svg_of(figure, name):
    """The figure as an <svg> element whose ids begin with `name`."""
    with pyplot.rc_context({"svg.hashsalt": name}):
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    pyplot.close(figure)
    svg = stream.getvalue()
    svg = svg[svg.index("<svg"):]
    for variable, stand_in in _STAND_INS.items():
        svg = svg.replace(stand_in, f"var(--{variable})")
    svg = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px", svg)
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.S)
    svg = re.sub(r'<g id="curve:([^"]*)"', r'<g data-curve="\1"', svg)  # what the choice of a method hides
    for kind in (r'id="', r'href="#', r"url\(#"):
        svg = re.sub(f"({kind})", rf"\g<1>{name}-", svg)
    svg = re.sub(r"<!--.*?-->\n? *", "", svg, flags=re.S)
    return re.sub(r'^<svg[^>]*?(viewBox="[^"]*")[^>]*>', r'<svg \1 aria-hidden="true" focusable="false">', svg)
