"""The main figures as PNG, for where no page can be shown."""

from .experiments.comparison import by_rate_figure, latency_figure
from .experiments.speed import growth_figure
from .load import Missing
from .theme import picture_colors, png_of

_MAIN = (("usable.png", "Usable lanes", lambda results: by_rate_figure(results, "usable [%]", "usable")),
         ("latency.png", "Latency", latency_figure),
         ("success.png", "Success, as the CLC paper counts", lambda results: by_rate_figure(results, "success [%]", "success")),
         ("iou.png", "Overlap with the ground truth", lambda results: by_rate_figure(results, "mean IoU [%]", "iou")),
         ("growth.png", "Latency by cone-set size", growth_figure))


def pictures(results):
    """(file name, bytes) of each main figure that the results can show; of several conditions, the papers'."""
    made = []
    if not results.samples:
        return made
    results = results.under(results.main_condition)
    with picture_colors():
        for name, title, figure_of in _MAIN:
            try:
                figure, axes = figure_of(results)
            except Missing:
                continue
            axes.set_title(title, loc="left", fontsize=10)
            made.append((name, png_of(figure)))
    return made
