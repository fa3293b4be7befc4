"""The main figures as PNG, for where no page can be shown."""

from .experiments import latency, quality, same_cone_set
from .theme import picture_colors, png_of

_MAIN = (("usable.png", "Usable lanes", quality.usable_figure),
         ("latency.png", "Latency", latency.by_rate_figure),
         ("success.png", "Success, as the CLC paper counts", quality.success_figure),
         ("iou.png", "Overlap with the ground truth", quality.iou_figure),
         ("growth.png", "Latency by cone-set size", same_cone_set.growth_figure))


def pictures(results):
    """(file name, bytes) of each main figure that the results can show; of several conditions, the papers'."""
    made = []
    if not results.samples:
        return made
    results = results.under(results.main_condition)
    with picture_colors():
        for name, title, figure_of in _MAIN:
            figure = figure_of(results)
            if figure is not None:
                figure.axes[0].set_title(title, loc="left", fontsize=10)
                made.append((name, png_of(figure)))
    return made
