"""Optima of RLD scenes by HiGHS (scipy.optimize.milp), from the equations of model/formulation.md alone: nothing here is
exported from conelane. Compares them with what `conelane solve` claims.

    highs_reference.py CONELANE WORK_FOLDER

Exit code 0: all agree; 1: a disagreement; 77: scipy with milp is not installed.
"""

import itertools
import json
import math
import os
import random
import subprocess
import sys

try:
    import numpy as np
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import csr_array
except ImportError as missing:
    print(f"SKIPPED: {missing} (Debian: python3-scipy)")
    sys.exit(77)

TIE = 1e-9
PARAMETERS = {
    "d_e": 3.2, "d_t": 1.7, "theta_e": math.pi, "theta_t": 0.9, "w_s": 0.4, "w_t": 0.5, "w_p": 1.2, "w_b": 1.0,
    "d_min": 2.5, "d_h": 6.0, "theta_heading": 1.2, "d_near": 6.0, "d_max": 6.5, "s_crit": 2.5, "t_crit": 4.0,
    "pairing": "near_far",
}
EXTRAS = {**PARAMETERS, "w_color": 0.3, "use_confidence": 1, "forbid_crossing": 1, "d_min": 0.0, "d_max": 16.0}
SHAPE = {**PARAMETERS, "w_u": 0.3, "w_v": 0.8, "w_n": 0.9, "d_w": 3.6, "d_v": 2.2, "theta_v": 0.4, "d_l": 2.5}


def point_to_segment(p, a, b):
    d = b - a
    t = min(1.0, max(0.0, float(np.dot(p - a, d)) / max(float(np.dot(d, d)), 1e-300)))
    return float(np.linalg.norm(a + t * d - p))


def cross(u, v):
    return float(u[0] * v[1] - u[1] * v[0])


def crossing(a, b, c, d):
    """The ends of each farther than a tie from the other's line, on both sides of it."""
    def apart(line, ends):
        along = line[1] - line[0]
        tie = TIE * float(np.linalg.norm(along))
        sides = [cross(along, end - line[0]) for end in ends]
        return min(sides) < -tie and max(sides) > tie
    return apart((a, b), (c, d)) and apart((c, d), (a, b))


def gap(a, b, c, d):
    """MinDist and End of (7)."""
    ends = min(float(np.linalg.norm(p - q)) for p in (a, b) for q in (c, d))
    if crossing(a, b, c, d):
        return 0.0, ends <= TIE
    smallest = min(point_to_segment(a, c, d), point_to_segment(b, c, d), point_to_segment(c, a, b),
                   point_to_segment(d, a, b))
    return smallest, ends <= smallest + TIE


def blue_and_yellow(cone):
    """Their probabilities, which `color_probabilities` has at places 1 and 2; without it those of the label."""
    if "color_probabilities" in cone:
        return cone["color_probabilities"][1:3]
    return [float(cone.get("color") == color) for color in ("blue", "yellow")]


class Model:
    """Rows (1)-(28) over columns a (edges), f (turns), g (cones); (5) and the pairing are added on demand."""

    def __init__(self, scene, p):
        self.p = p
        self.at = [np.array([cone["x"], cone["y"]]) for cone in scene["cones"]]
        self.n = len(self.at)
        self.car = np.array([scene["pose"]["x"], scene["pose"]["y"]])
        yaw = scene["pose"]["yaw"]
        self.heading = np.array([math.cos(yaw), math.sin(yaw)])
        self.near = [float(np.linalg.norm(c - self.car)) <= p["d_near"] + TIE for c in self.at]
        self.edges = list(itertools.combinations(range(self.n), 2))
        self.a = {edge: k for k, edge in enumerate(self.edges)}
        self.turns = [(i, j, k) for j in range(self.n) for i in range(self.n) for k in range(i + 1, self.n)
                      if j not in (i, k)]
        self.f = {turn: len(self.edges) + k for k, turn in enumerate(self.turns)}
        self.g = [len(self.edges) + len(self.turns) + i for i in range(self.n)]
        self.columns = len(self.edges) + len(self.turns) + self.n
        self.cost = np.zeros(self.columns)
        self.upper = np.ones(self.columns)
        self.rows = []
        self.along = []
        self.costs(scene)
        self.constraints()

    def edge(self, i, j):
        return self.a[(min(i, j), max(i, j))]

    def length(self, i, j):
        return float(np.linalg.norm(self.at[i] - self.at[j]))

    def costs(self, scene):
        p = self.p
        cones = scene["cones"]
        for (i, j), column in self.a.items():
            v = self.at[j] - self.at[i]
            middle = (self.at[i] + self.at[j]) / 2
            s = ((self.length(i, j) - p["d_e"]) / p["d_t"]) ** 4
            across = abs(cross(v, self.heading))
            heading = (across / max(float(np.linalg.norm(middle - self.car)), 0.5)) ** 4
            angle = math.atan2(across, abs(float(np.dot(v, self.heading))))
            along = (point_to_segment(self.car, self.at[i], self.at[j]) <= p["d_h"] + TIE
                     and angle <= p["theta_heading"] + TIE)
            if along:
                self.along.append(column)
            benefit = p["w_b"]
            if p.get("use_confidence"):
                benefit *= cones[i].get("confidence", 1.0) * cones[j].get("confidence", 1.0)
            blue, yellow = zip(blue_and_yellow(cones[i]), blue_and_yellow(cones[j]))
            color = blue[0] * yellow[1] + blue[1] * yellow[0]
            # Left of the car by its axis and by the edge's own line, taken along the heading; or right by both.
            forward = float(np.dot(v, self.heading))
            lefts = (cross(self.heading, middle - self.car), math.copysign(1, forward) * cross(v, middle - self.car))
            if along and abs(forward) > TIE:
                wrong = blue if max(lefts) < -TIE else yellow if min(lefts) > TIE else (0.0, 0.0)
                color += 1 - (1 - wrong[0]) * (1 - wrong[1])
            self.cost[column] = p["w_s"] * s + p["w_p"] * heading + p.get("w_color", 0.0) * color - benefit
            if "w_v" in p:
                self.cost[column] += p["w_v"] * self.facing_cost(i, j)
            if s > p["s_crit"] + TIE or self.length(i, j) == 0.0:
                self.upper[column] = 0.0  # (27)
        for (i, j, k), column in self.f.items():
            u, v = self.at[i] - self.at[j], self.at[k] - self.at[j]
            angle = math.atan2(abs(cross(u, v)), float(np.dot(u, v)))
            t = ((angle - p["theta_e"]) / p["theta_t"]) ** 4
            self.cost[column] = p["w_t"] * t
            if "w_u" in p:
                self.cost[column] += p["w_u"] * ((self.length(i, j) - self.length(j, k)) / p["d_t"]) ** 2
            if t > p["t_crit"] + TIE:
                self.upper[column] = 0.0  # (28)

        for i in range(self.n):
            if "w_n" in p and self.near[i]:  # a benefit where i ends a path
                side = abs(cross(self.heading, self.at[i] - self.car))
                fit = max(0.0, 1 - ((side - p["d_w"] / 2) / p["d_t"]) ** 2)
                for column, factor in self.mark(i, -p["w_n"] * fit):
                    self.cost[column] += factor

    def facing_cost(self, i, j):
        """How badly the edge that faces {i, j} best does."""
        p, best = self.p, 1.0
        v = (self.at[j] - self.at[i]) / max(self.length(i, j), 1e-300)
        for k, l in self.edges:
            if {i, j} & {k, l} or self.length(k, l) == 0.0:
                continue
            if ((self.length(k, l) - p["d_e"]) / p["d_t"]) ** 4 > p["s_crit"] + TIE:
                continue
            way = (self.at[k] + self.at[l] - self.at[i] - self.at[j]) / 2
            sine = cross(v, self.at[l] - self.at[k]) / self.length(k, l)
            best = min(best, (float(np.dot(v, way)) ** 2 + (abs(cross(v, way)) - p["d_w"]) ** 2) / p["d_v"] ** 2
                       + (sine / p["theta_v"]) ** 2
                       + ((self.length(k, l) - self.length(i, j)) / p["d_l"]) ** 2)
        return best

    def row(self, terms, lower, upper):
        self.rows.append((terms, lower, upper))

    def mark(self, i, factor=1.0):
        """factor * m_i, m_i = 2 g_i - A_i."""
        return [(self.g[i], 2 * factor)] + [(self.edge(i, j), -factor) for j in range(self.n) if j != i]

    def constraints(self):
        p, inf = self.p, np.inf
        for i in range(self.n):
            degree = [(self.edge(i, j), 1) for j in range(self.n) if j != i]
            self.row(degree + [(self.g[i], -1)], 0, inf)  # (1)
            self.row(degree + [(self.g[i], -2)], -inf, 0)  # (2)
        self.row(sum((self.mark(i) for i in range(self.n)), []), 4, 4)  # (3)
        for e, f in itertools.combinations(self.edges, 2):  # (6)-(8)
            if set(e) & set(f):
                continue
            corners = [self.at[c] for c in (*e, *f)]
            distance, end = gap(*corners)
            if (distance < p["d_min"] - TIE and not end) or (p.get("forbid_crossing") and crossing(*corners)):
                self.row([(self.a[e], 1), (self.a[f], 1)], -inf, 1)
        self.row([(column, 1) for column in self.along], 2, inf)  # (9)
        self.row(sum((self.mark(i) for i in range(self.n) if self.near[i]), []), 2, 2)  # (11)
        for i, j in self.edges:  # (12)-(17): of two far cones too far apart, one is no endpoint
            if not self.near[i] and not self.near[j] and self.length(i, j) > p["d_max"] + TIE:
                self.row(self.mark(i) + self.mark(j), -inf, 1)
        for (i, j, k), column in self.f.items():
            both = [(self.edge(i, j), -1), (self.edge(j, k), -1)]
            self.row([(column, 2)] + both, -inf, 0)  # (22)
            self.row([(column, 1)] + both, -1, inf)  # (23)

    def solve_once(self):
        indices, columns, values, lower, upper = [], [], [], [], []
        for r, (terms, low, high) in enumerate(self.rows):
            for column, value in terms:
                indices.append(r)
                columns.append(column)
                values.append(value)
            lower.append(low)
            upper.append(high)
        matrix = csr_array((values, (indices, columns)), shape=(len(self.rows), self.columns))
        return milp(self.cost, integrality=np.ones(self.columns), bounds=Bounds(np.zeros(self.columns), self.upper),
                    constraints=LinearConstraint(matrix, lower, upper), options={"mip_rel_gap": 0.0})

    def components(self, chosen):
        """Cone sets that the edges connect."""
        left = {cone for edge in chosen for cone in edge}
        while left:
            component, open_ = set(), [left.pop()]
            while open_:
                cone = open_.pop()
                component.add(cone)
                for edge in chosen:
                    if cone in edge:
                        other = edge[0] + edge[1] - cone
                        if other in left:
                            left.discard(other)
                            open_.append(other)
            yield component

    def optimum(self):
        """Objective of the best lane graph, None without one."""
        while True:
            result = self.solve_once()
            if result.status == 2:
                return None
            if result.status != 0:
                raise RuntimeError(f"HiGHS: {result.message}")
            chosen = [edge for edge, column in self.a.items() if result.x[column] > 0.5]
            violated = False
            for component in self.components(chosen):
                inside = [edge for edge in chosen if edge[0] in component]
                ends = [c for c in component if sum(c in edge for edge in inside) == 1]
                if not ends:  # (5)
                    pairs = itertools.combinations(sorted(component), 2)
                    self.row([(self.a[pair], 1) for pair in pairs], -np.inf, len(component) - 1)
                    violated = True
                elif self.p["pairing"] == "near_far" and all(self.near[c] for c in ends):
                    path = {self.a[edge] for edge in inside}
                    out = {self.edge(e, c) for e in ends for c in range(self.n) if c != e} - path
                    self.row([(c, 1) for c in path] + [(c, -1) for c in out], -np.inf, len(path) - 1)
                    violated = True
            if not violated:
                return float(result.fun)


def lines_of(path):
    with open(path, encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def main():
    conelane, folder = sys.argv[1:]
    os.makedirs(folder, exist_ok=True)
    scenes_file = os.path.join(folder, "highs.scenes.jsonl")
    subprocess.run([conelane, "scenes", "--tracks", "generated:circle", "generated:hairpins", "--fp", "0.3", "--every",
                    "12", "--nearest", "9", "--color", "--out", scenes_file], check=True, stdout=subprocess.DEVNULL)
    scenes = lines_of(scenes_file)[:30]
    seeded = random.Random(1)
    for scene in scenes:
        for cone in scene["cones"]:
            cone["confidence"] = round(seeded.uniform(0.3, 1.0), 3)
    with open(scenes_file, "w", encoding="utf-8") as file:
        file.writelines(json.dumps(scene) + "\n" for scene in scenes)
    disagreements = feasible = 0
    for name, parameters in (("paper", PARAMETERS), ("extras", EXTRAS), ("shape", SHAPE)):
        parameter_file = os.path.join(folder, f"{name}.json")
        with open(parameter_file, "w", encoding="utf-8") as file:
            json.dump(parameters, file)
        optima = {scene["id"]: Model(scene, parameters).optimum() for scene in scenes}
        for formulation, solver in (("tight", "cbc"), ("paper", "cbc-main")):
            out = os.path.join(folder, f"{name}.{formulation}.solutions.jsonl")
            subprocess.run([conelane, "solve", "--solver", solver, "--formulation", formulation, "--scenes", scenes_file,
                            "--params", parameter_file, "--out", out], check=True)
            for record in lines_of(out):
                expected = optima[record["scene"]]
                feasible += expected is not None
                if expected is None:
                    right = record["status"] == "infeasible"
                else:
                    right = record["status"] == "optimal" and abs(record["objective"] - expected) < 1e-6
                if not right:
                    disagreements += 1
                    print(f"{record['scene']} ({name}, {formulation}): HiGHS {expected}, conelane {record['status']} "
                          f"{record.get('objective')}")
    print(f"{len(scenes)} scenes, {feasible} comparisons of optima, {disagreements} disagreements")
    return 1 if disagreements or feasible < len(scenes) else 0


if __name__ == "__main__":
    sys.exit(main())
