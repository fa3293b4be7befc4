"""What the named conditions are, in words."""

import math


def _told(conditions, name, disturbed):
    """Empty where the program does not know the condition."""
    known = next((condition for condition in conditions if condition["name"] == name), None)
    if known is None:
        return "", known
    text = disturbed if known["noise_m"] or known["miss_rate"] else "nothing disturbed"
    return text.format(**known, yaw=math.degrees(known["pose_yaw_rad"]), missed=100 * known["miss_rate"]), known


def short(conditions, name):
    """A few words that stand beside a name."""
    return _told(conditions, name, "cones off by {noise_m:g} m, pose by {pose_lateral_m:g} m and {yaw:.0f}°, {missed:g} % missed")[0]


def whole(conditions, name):
    text, known = _told(conditions, name, "noise of {noise_m:g} m on seen positions, a pose {pose_lateral_m:g} m and "
                        "{yaw:.0f}° off (one sigma each), {missed:g} % of the cones missed")
    return text and text + ("; false positives stay where they are along a lap" if known["persistent"] else
                            "; false positives are drawn again at every pose")
