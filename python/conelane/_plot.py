"""Drawing of a lane."""
from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from . import Lane

# Colours that colour-blind people tell apart, on white and on black.
_LEFT = "#2a7de1"
_RIGHT = "#e0a000"
_CONE = "#8a8a8a"
_CENTRE = "#00936f"


def _draw_boundary(ax: Axes, points: NDArray[np.float64], closed: bool, color: str, label: str) -> None:
    if closed:
        points = np.vstack([points, points[:1]])
    ax.plot(points[:, 0], points[:, 1], "o-", color=color, label=label, markersize=5)


def plot_lane(lane: Lane, ax: Optional[Axes] = None) -> Axes:
    """Cones, boundaries, centre line and car of `lane`, on `ax` or the axes of the current figure."""
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.gca()
    cones, (x, y, yaw) = lane.cones, lane.pose
    ax.plot(cones[:, 0], cones[:, 1], "o", color=_CONE, label="cones", markersize=4)
    if lane.found:
        _draw_boundary(ax, lane.left_points, lane.closed, _LEFT, "left")
        _draw_boundary(ax, lane.right_points, lane.closed, _RIGHT, "right")
        line = lane.centre_line()
        ax.plot(line[:, 1], line[:, 2], "--", color=_CENTRE, label="centre line")
    ax.quiver(x, y, np.cos(yaw), np.sin(yaw), angles="xy", scale_units="xy", scale=0.5, color=_CENTRE)
    ax.set_aspect("equal")
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    return ax
