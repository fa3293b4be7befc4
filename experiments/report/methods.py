"""What each method does, in a line, and whose it is."""

from dataclasses import dataclass

RLD_PAPER = ("RLD", "Kathleen Brandes, Allen Wang, Rushina Shah: Robust Lane Detection with Binary Integer Optimization")
CLC_PAPER = ("CLC", "Ivo Ivanov, Carsten Markgraf: Lane Detection using Graph Search and Geometric Constraints for Formula "
                    "Student Driverless")


@dataclass(frozen=True)
class Description:
    line: str
    source: str


def _rld(line):
    return Description(line, "RLD paper")


def _rld_here(line):
    return Description(line, "RLD paper, extended here")


def _clc_here(line):
    return Description(line, "CLC paper, extended here")


_KNOWN = {
    "front": Description("Grows the left and the right boundary together, cone by cone, under a learned cost; a beam search "
                         "keeps the best pairs, a second network picks one and says how sure it is.", "this project"),
    "front-warm": Description("front, which favours the cones of its last lane.", "this project"),
    "clc": _clc_here("Enumerates pairs of paths through a graph of near cones under geometric constraints, the most promising "
                     "first, and takes the one that a small network ranks best."),
    "clc-warm": _clc_here("clc, which starts from its last lane."),
    "clc-no-beam": _clc_here("clc without the quick search that leads it."),
    "clc-paper": Description("The same search with the paper's own eight features and ranking.", "CLC paper"),
    "clc-delaunay": Description("clc-paper on the Delaunay triangulation of the cones.", "CLC paper"),
    "clc-longest": Description("The same search; the longest lane is taken instead of ranking.", "CLC paper, cut down"),
    "rld-cbc": _rld("Chooses edges between the 12 nearest cones at the least total cost, as a binary program that CBC solves to "
                    "proven optimality."),
    "rld-paper": _rld("The same program as printed, by CBC's full machinery."),
    "rld-pair": _rld_here("The same objective on all cones, by an exact search over pairs of paths."),
    "rld-shape": _rld_here("rld-pair with three more costs, for the shape of the lane: another objective, another optimum."),
    "rld-context": _rld_here("Looks at 24 cones and answers for the 12 nearest."),
    "rld-learned": _rld_here("rld-pair with learned costs of edges, turns and ends; steps over missed cones."),
    "rld-shape-context": _rld_here("rld-context with the costs of the lane's shape."),
    "delaunay-beam": Description("Beam search for a centre line through the Delaunay triangulation of the cones, as the team AMZ "
                                 "drove with.", "baseline"),
    "astar-lane": Description("A path of bounded curvature between the cones by A*; the boundaries are read off it.",
                              "baseline, after Tanzmeister et al."),
}


def described(results, name):
    """Description of a method; of one from outside what its row says."""
    if name in _KNOWN:
        return _KNOWN[name]
    row = next((row for row in results.rows if row["method"] == name), {})
    title = row.get("card", {}).get("name", "")
    if "outside" in row:
        return Description(f"{title}, a method from outside." if title else "A method from outside.", "its authors")
    return Description("", "")
