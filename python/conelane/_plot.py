"""Drawing of a lane."""
from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from . import Lane

# Colours that colour-blind people tell apart, on white and on black.
_LEFT, _RIGHT, _CONE, _CENTRE = "#2a7de1", "#e0a000", "#8a8a8a", "#00936f"


def plot_lane(lane: Lane, ax: Optional[Axes] = None) -> Axes:
    """Cones, boundaries, centre line and car of `lane`, on `ax` or the axes of the current figure."""
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.gca()
    ax.plot(*lane.cones.T, "o", color=_CONE, label="cones", markersize=4)
    if lane.found:
        for points, color, label in ((lane.left_points, _LEFT, "left"), (lane.right_points, _RIGHT, "right")):
            ax.plot(*np.vstack([points, points[:int(lane.closed)]]).T, "o-", color=color, label=label, markersize=5)
        ax.plot(*lane.centre_line()[:, 1:3].T, "--", color=_CENTRE, label="centre line")
    x, y, yaw = lane.pose
    ax.quiver(x, y, np.cos(yaw), np.sin(yaw), angles="xy", scale_units="xy", scale=0.5, color=_CENTRE)
    ax.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    return ax
