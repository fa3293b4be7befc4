"""What each method does, in a line, and whose it is; what the named conditions are."""

import math

RLD_PAPER = ("RLD", "Kathleen Brandes, Allen Wang, Rushina Shah: Robust Lane Detection with Binary Integer Optimization")
CLC_PAPER = ("CLC", "Ivo Ivanov, Carsten Markgraf: Lane Detection using Graph Search and Geometric Constraints for Formula "
                    "Student Driverless")

_OF_SOURCE = {
    "this project": {
        "front": "Grows the left and the right boundary together, cone by cone, under a learned cost; a beam search "
                 "keeps the best pairs, a second network picks one and says how sure it is.",
        "front-warm": "front, which favours the cones of its last lane."},
    "CLC paper, extended here": {
        "clc": "Enumerates pairs of paths through a graph of near cones under geometric constraints, the most promising "
               "first, and takes the one that a small network ranks best.",
        "clc-warm": "clc, which starts from its last lane."},
    "CLC paper": {"clc-paper": "The same search with the paper's own eight features and ranking."},
    "RLD paper": {
        "rld-cbc": "Chooses edges between the 12 nearest cones at the least total cost, as a binary program that CBC solves to "
                   "proven optimality.",
        "rld-paper": "The same program as printed, by CBC's full machinery."},
    "RLD paper, extended here": {
        "rld-pair": "The same objective on all cones, by an exact search over pairs of paths.",
        "rld-shape": "rld-pair with three more costs, for the shape of the lane: another objective, another optimum.",
        "rld-context": "Looks at 24 cones and answers for the 12 nearest.",
        "rld-learned": "rld-pair with learned costs of edges, turns and ends; steps over missed cones.",
        "rld-strip": "The cheapest strip of triangles between two boundaries, by learned costs of both together, with proof."}}


def described(results, name):
    """(line, source) of a method; of one from outside what its row says."""
    for source, lines in _OF_SOURCE.items():
        if name in lines:
            return lines[name], source
    row = next((row for row in (results.rows if results else []) if row["method"] == name), {})
    title = row.get("card", {}).get("name", "")
    if "outside" in row:
        return f"{title}, a method from outside." if title else "A method from outside.", "its authors"
    return "", ""


def _told(conditions, name, disturbed):
    """Empty where the program does not know the condition."""
    known = next((condition for condition in conditions if condition["name"] == name), None)
    if known is None:
        return "", known
    text = disturbed if known["noise_sigma_m"] or known["miss_rate"] else "nothing disturbed"
    return text.format(**known, yaw=math.degrees(known["pose_noise_yaw_rad"]), missed=100 * known["miss_rate"]), known


def short(conditions, name):
    """A few words that stand beside a name."""
    return _told(conditions, name, "cones off by {noise_sigma_m:g} m, pose by {pose_noise_lateral_m:g} m and {yaw:.0f}°, {missed:g} % missed")[0]


def whole(conditions, name):
    text, known = _told(conditions, name, "noise of {noise_sigma_m:g} m on seen positions, a pose {pose_noise_lateral_m:g} m and "
                        "{yaw:.0f}° off (one sigma each), {missed:g} % of the cones missed")
    return text and text + ("; false positives stay where they are along a lap" if known["persistent"] else
                            "; false positives are drawn again at every pose")
