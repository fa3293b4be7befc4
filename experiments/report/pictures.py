"""The main figures as PNG, for where no page can be shown."""

from .experiments import latency, quality, same_cone_set
from .theme import picture_colors, png_of

_MAIN = (("usable.png", quality.usable_figure), ("latency.png", latency.by_rate_figure),
         ("success.png", quality.success_figure), ("iou.png", quality.iou_figure),
         ("growth.png", same_cone_set.growth_figure))


def pictures(results):
    """(file name, bytes) of each main figure that the results can show; of several conditions, the papers'."""
    made = []
    results = results.under(results.main_condition)
    with picture_colors():
        for name, figure_of in _MAIN:
            figure = figure_of(results)
            if figure is not None:
                made.append((name, png_of(figure)))
    return made
