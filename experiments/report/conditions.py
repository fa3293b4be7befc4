"""What the named conditions are, in words."""

import math


def _known(conditions, name):
    return next((condition for condition in conditions if condition["name"] == name), None)


def short(conditions, name):
    """A few words that stand beside a name; empty where the program does not know it."""
    known = _known(conditions, name)
    if known is None:
        return ""
    if not known["noise_m"] and not known["miss_rate"]:
        return "nothing disturbed"
    return (f"cones off by {known['noise_m']:g} m, pose by {known['pose_lateral_m']:g} m and "
            f"{math.degrees(known['pose_yaw_rad']):.0f}°, {100 * known['miss_rate']:g} % missed")


def whole(conditions, name):
    """All of it; empty where the program does not know it."""
    known = _known(conditions, name)
    if known is None:
        return ""
    disturbed = known["noise_m"] or known["miss_rate"]
    what = (f"noise of {known['noise_m']:g} m on seen positions, a pose {known['pose_lateral_m']:g} m and "
            f"{math.degrees(known['pose_yaw_rad']):.0f}° off (one sigma each), "
            f"{100 * known['miss_rate']:g} % of the cones missed" if disturbed else "nothing disturbed")
    strays = ("false positives stay where they are along a lap" if known["persistent"] else
              "false positives are drawn again at every pose")
    return f"{what}; {strays}"
