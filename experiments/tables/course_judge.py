"""course_judge.py FOLDER: how accurate a lane of the nearest 12 cones can be expected to be, by what the other families say of courses.

FOLDER has FAMILY.scenes.jsonl and FAMILY.tracks.json of each family. Writes FAMILY.judge.lanes.jsonl (the answers of the judge below),
FAMILY.truth.lanes.jsonl (the truth as an answer) and course_judge.json (a row for each family and rate).

The model. A lane grows from the car: always the boundary that is behind gets its next cone, or ends. The place of the next cone has a density
given the last cones of both boundaries: a linear regression and a mixture of normal distributions around it, both fitted to the true lanes of
the other families. A boundary ends where its next cone is out of view, or with a small probability. False cones are uniform in the view; their rate
is known. Cones of other legs are uniform too, with one density beside the lane and another one far from it. This gives each lane a posterior
probability; a beam search finds the probable lanes. A power of the probabilities, at most 1, allows for courses that differ from those that
were seen. The power that suits the other families best is taken.

The judge answers the lane that has at most one wrong cone with the highest probability. `expected` is the mean of this probability, `attained`
the share of the scenes in which it is so. The true lane is always among the lanes, also where the beam search loses it. The other checks of
`accurate` are left to `conelane score`.
"""

import json
import math
import os
import random
import sys
from collections import defaultdict

import numpy as np

CONTEXT, NEAREST = 24, 12
WIDEST_M = 6.5
VIRTUAL_M = 4.0  # from the first cone of a boundary back along the car's heading: the cone before it
REACH_M = 13.0  # longest step
BEAM, KEPT = 60, 80
COMPONENTS = 3
SMOOTHING_M2 = 0.05**2  # other courses differ from those that were seen
BESIDE_M = 2.5  # from a boundary: beside the lane
POWERS = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3)
STRAY = (0.02, 2.0**2)  # weight and variance of a wide component, for the same reason


class Density:
    """Density of a point in the plane given features: a mixture of normal distributions around a linear regression."""

    def __init__(self, weights, components):
        self.weights = weights  # a row for x, a row for y
        self.components = components  # (share, mean x, mean y, variance x, covariance, variance y)
        self.forms = []
        for share, x, y, xx, xy, yy in components:
            det = xx * yy - xy * xy
            self.forms.append((share / (2 * math.pi * math.sqrt(det)), x, y, -0.5 * yy / det, xy / det, -0.5 * xx / det))
        source = random.Random(1)
        self.residuals = [self.draw(source) for _ in range(48)]

    def draw(self, source):
        share, x, y, xx, xy, yy = source.choices(self.components, [component[0] for component in self.components])[0]
        first, second = source.gauss(0, 1), source.gauss(0, 1)
        sx = math.sqrt(xx)
        return x + sx * first, y + xy / sx * first + math.sqrt(yy - xy * xy / xx) * second

    def mean(self, features):
        return tuple(sum(w * f for w, f in zip(row, features)) for row in self.weights)

    def log(self, x, y):
        """Of a residual."""
        total = 0.0
        for scale, mx, my, xx, xy, yy in self.forms:
            u, v = x - mx, y - my
            total += scale * math.exp(xx * u * u + xy * u * v + yy * v * v)
        return math.log(max(total, 1e-30))


def fitted(features, targets):
    """The density of the targets given the features, by least squares and expectation maximisation."""
    features, targets = np.array(features), np.array(targets)
    ridge = 1e-3 * np.eye(features.shape[1])
    weights = np.linalg.solve(features.T @ features + ridge, features.T @ targets).T
    residuals = targets - features @ weights.T
    spread = np.cov(residuals.T) + SMOOTHING_M2 * np.eye(2)
    parts = [(1 / COMPONENTS, np.zeros(2), spread * factor) for factor in (0.05, 0.5, 3.0)]
    for _ in range(40):
        dense = np.stack([share * np.exp(-0.5 * np.einsum("ij,jk,ik->i", residuals - mean, np.linalg.inv(cov), residuals - mean))
                          / (2 * math.pi * math.sqrt(np.linalg.det(cov))) for share, mean, cov in parts])
        owned = dense / np.maximum(dense.sum(axis=0), 1e-300)
        parts = []
        for own in owned:
            total = own.sum() + 1e-6
            mean = own @ residuals / total
            cov = (own[:, None] * (residuals - mean)).T @ (residuals - mean) / total + SMOOTHING_M2 * np.eye(2)
            parts.append((total / len(residuals), mean, cov))
    kept = 1 - STRAY[0]
    components = [(kept * share, *mean, cov[0, 0], cov[0, 1], cov[1, 1]) for share, mean, cov in parts]
    return Density(weights.tolist(), [tuple(map(float, c)) for c in components] + [(STRAY[0], 0.0, 0.0, STRAY[1], 0.0, STRAY[1])])


class View:
    """The nearest cones ahead of the car, in its frame; `radius_m`: they are all cones up to there."""

    def __init__(self, places, radius_m, false_density):
        self.places, self.radius_m, self.false_density = places, radius_m, false_density

    def contains(self, x, y):
        return x >= 0.0 and x * x + y * y <= self.radius_m**2

    def margin(self, x, y):
        return min(x, self.radius_m - math.hypot(x, y))


def direction(a, b):
    length = math.hypot(b[0] - a[0], b[1] - a[1]) or 1e-9
    return (b[0] - a[0]) / length, (b[1] - a[1]) / length, length


def points_of(chain, places):
    """The last three points of a boundary; points behind the car stand for cones that are not there."""
    known = [places[cone] for cone in chain[-3:]]
    while len(known) < 3:
        known.insert(0, (known[0][0] - VIRTUAL_M, known[0][1]))
    return known


def side_to_grow(lane, ended, places):
    """0 left, 1 right, None: the lane is complete."""
    if not lane[0] or not lane[1]:
        return 0 if not lane[0] else 1
    if ended[0] or ended[1]:
        return None if all(ended) else int(ended[0])
    left, right = points_of(lane[0], places), points_of(lane[1], places)
    ux, uy, _ = direction(left[1], left[2])
    vx, vy, _ = direction(right[1], right[2])
    return 0 if (left[2][0] - right[2][0]) * (ux + vx) + (left[2][1] - right[2][1]) * (uy + vy) <= 0.0 else 1


class Context:
    """Where the next cone of a boundary is looked for: the kind of the density, its features, and the frame of its targets. In the frame, x is
    along the last edge and the other boundary is at positive y."""

    def __init__(self, lane, side, ended, places):
        self.sign = -1.0 if side == 0 else 1.0
        other = lane[1 - side]
        if not lane[side]:
            self.origin, self.ahead = (0.0, 0.0), (1.0, 0.0)
            self.kind = "facing" if other else "first"
            self.features = (1.0, *self.local(places[other[0]])) if other else (1.0,)
            return
        before, last_but_one, last = points_of(lane[side], places)
        ux, uy, length = direction(last_but_one, last)
        self.origin, self.ahead = last, (ux, uy)
        bx, by, _ = direction(before, last_but_one)
        turn = self.sign * (bx * uy - by * ux)
        _, facing_before, facing = points_of(other, places)
        qx, qy = self.local(facing)
        ox, oy, _ = direction(facing_before, facing)
        slant = self.sign * (ux * oy - uy * ox)
        if ended[1 - side] or abs(qx) > 8.0 or not 0.0 < qy < 9.0:
            self.kind, self.features = "alone", (1.0, length, turn)
        elif len(lane[side]) == 1:
            self.kind, self.features = "second", (1.0, qx, qy, slant)
        else:
            self.kind, self.features = "next", (1.0, length, turn, qx, qy, slant, length * turn, length * slant)

    def local(self, point):
        x, y = point[0] - self.origin[0], point[1] - self.origin[1]
        ux, uy = self.ahead
        return ux * x + uy * y, self.sign * (ux * y - uy * x)

    def place(self, x, y):
        ux, uy = self.ahead
        y *= self.sign
        return self.origin[0] + ux * x - uy * y, self.origin[1] + uy * x + ux * y


def decisions(lane, places):
    """What the growth of a lane decides: (context, cone or None for an end)."""
    grown, ended = ([], []), [False, False]
    while (side := side_to_grow(grown, ended, places)) is not None:
        context = Context(grown, side, ended, places)
        index = len(grown[side])
        cone = lane[side][index] if index < len(lane[side]) else None
        yield context, cone
        if cone is None:
            ended[side] = True
        else:
            grown[side].append(cone)


class Model:
    def __init__(self, densities, early_end, beside=0.0, far=0.0):
        self.densities = densities
        self.early_end = early_end  # probability that a boundary ends although its next cone would be in view
        self.beside, self.far = beside, far  # true cones of no boundary of the lane, for each m²

    def out_of_view(self, context, mean, view):
        if view.margin(*context.place(*mean)) > 8.0:
            return 0.0
        residuals = self.densities[context.kind].residuals
        return sum(not view.contains(*context.place(mean[0] + x, mean[1] + y)) for x, y in residuals) / len(residuals)

    def options(self, context, view):
        """Log weight of each next cone and, under None, of the end; a cone counts against a uniform one."""
        density = self.densities[context.kind]
        mean = density.mean(context.features)
        can_end = context.kind not in ("first", "facing")
        stay = math.log(1.0 - self.early_end) if can_end else 0.0
        found = {}
        for cone, place in view.places.items():
            x, y = context.local(place)
            if x * x + y * y <= REACH_M**2:
                found[cone] = stay + density.log(x - mean[0], y - mean[1]) - math.log(self.far + view.false_density)
        if can_end:
            found[None] = math.log(self.early_end + (1.0 - self.early_end) * self.out_of_view(context, mean, view))
        return found

    def log_of_others(self, lane, view):
        """Log weight of the cones that are not in the lane, against those far from it."""
        if self.beside == self.far:
            return 0.0
        number, area_m2 = beside(lane, view)
        return number * math.log((self.beside + view.false_density) / (self.far + view.false_density)) - area_m2 * (self.beside - self.far)


def beside(lane, view):
    """How many cones of no boundary are beside the lane, and the area [m²] that this is, without the overlap of its parts."""
    lines = [[view.places[cone] for cone in chain] for chain in lane]
    number = sum(min(distance_m(place, line) for line in lines) < BESIDE_M
                 for cone, place in view.places.items() if cone not in lane[0] and cone not in lane[1])
    return number, 2 * BESIDE_M * sum(math.dist(a, b) for line in lines for a, b in zip(line, line[1:]))


def learn(examples):
    """The model of views without false cones, with their lanes."""
    features, targets = defaultdict(list), defaultdict(list)
    ends, steps = 1.0, 50.0
    near, far, near_m2, far_m2 = 1.0, 1.0, 1e3, 1e3  # as if one cone had been seen
    for view, lane in examples:
        for context, cone in decisions(lane, view.places):
            if cone is not None:
                features[context.kind].append(context.features)
                targets[context.kind].append(context.local(view.places[cone]))
                steps += 1
        number, area_m2 = beside(lane, view)
        near += number
        near_m2 += area_m2
        far += len(view.places) - len(lane[0]) - len(lane[1]) - number
        far_m2 += max(0.0, 0.5 * math.pi * view.radius_m**2 - area_m2)
    densities = {kind: fitted(features[kind], targets[kind]) for kind in features}
    model = Model(densities, 0.5, near / near_m2, far / far_m2)
    for view, lane in examples:
        for context, cone in decisions(lane, view.places):
            if cone is None:  # the share of the ends that the view does not explain
                ends += 1.0 - model.out_of_view(context, densities[context.kind].mean(context.features), view)
    model.early_end = ends / (ends + steps)
    return model


def posterior(model, view, also=None):
    """The probable lanes, each with its probability. `also`: a lane that is among them in any case."""
    memo = {}

    def options(lane, side, ended):
        key = side, lane[side][-3:], lane[1 - side][-2:], ended[1 - side]
        if key not in memo:
            found = model.options(Context(lane, side, ended, view.places), view)
            best = max(found.values())
            memo[key] = [(cone, weight) for cone, weight in found.items() if weight > best - 12.0]
        return memo[key]

    complete, beam = {}, [(0.0, ((), ()), (False, False))]
    while beam:
        grown = []
        for score, lane, ended in beam:
            side = side_to_grow(lane, ended, view.places)
            if side is None:
                complete[lane] = score + model.log_of_others(lane, view)
                continue
            for cone, weight in options(lane, side, ended):
                if cone is None:
                    grown.append((score + weight, lane, (True, ended[1]) if side == 0 else (ended[0], True)))
                elif cone not in lane[0] and cone not in lane[1]:
                    longer = lane[side] + (cone,)
                    grown.append((score + weight, (longer, lane[1]) if side == 0 else (lane[0], longer), ended))
        grown.sort(key=lambda state: -state[0])
        beam = grown[:BEAM]
    if also is not None and also not in complete:
        complete[also] = model.log_of_others(also, view) + sum(model.options(context, view).get(cone, -60.0)
                                                               for context, cone in decisions(also, view.places))
    best = max(complete.values())
    kept = sorted(complete.items(), key=lambda item: -item[1])[:KEPT]
    if also is not None and also not in dict(kept):
        kept.append((also, complete[also]))
    total = sum(math.exp(score - best) for _, score in kept)
    return [(lane, math.exp(score - best) / total) for lane, score in kept]


def distance_m(point, line):
    if len(line) == 1:
        return math.dist(point, line[0])
    shortest = math.inf
    for (ax, ay), (bx, by) in zip(line, line[1:]):
        x, y = bx - ax, by - ay
        along = ((point[0] - ax) * x + (point[1] - ay) * y) / ((x * x + y * y) or 1e-12)
        along = min(1.0, max(0.0, along))
        shortest = min(shortest, math.hypot(point[0] - ax - along * x, point[1] - ay - along * y))
    return shortest


def cut(lane, inside, places):
    """The lane up to the first cone that is not inside, with even far ends; as model/lane.cpp."""
    sides = []
    for chain in lane:
        first_outside = next((i for i, cone in enumerate(chain) if cone not in inside), len(chain))
        sides.append(list(chain[:first_outside]))
    while sides[0] and sides[1]:
        lines = [[places[cone] for cone in side] for side in sides]
        far = [distance_m(lines[i][-1], lines[1 - i]) > WIDEST_M for i in (0, 1)]
        if not any(far):
            break
        sides[0 if far[0] else 1].pop()
    return tuple(sides[0]), tuple(sides[1])


def shortened(lanes, inside, places):
    """The lanes of the cones inside. Only lanes with two cones a side count."""
    short = [(cut(lane, inside, places), probability) for lane, probability in lanes]
    return [(lane, probability) for lane, probability in short if len(lane[0]) >= 2 and len(lane[1]) >= 2]


def judged(lanes, power=1.0):
    """The answer that has at most one wrong cone with the highest probability, and that probability."""
    mass = defaultdict(float)
    for lane, probability in lanes:
        mass[lane] += probability**power
    if not mass:
        return ((), ()), 0.0
    total = sum(mass.values())
    sets = {lane: frozenset(lane[0] + lane[1]) for lane in mass}

    def value(answer):
        return sum(p for lane, p in mass.items() if len(sets[lane] ^ sets[answer]) <= 1) / total
    best = max(sorted(mass, key=lambda lane: -mass[lane])[:30], key=value)
    return best, value(best)


def is_right(answer, truth):
    return len(set(answer[0] + answer[1]) ^ set(truth[0] + truth[1])) <= 1


def log_likelihoods(outcomes):
    """How likely it is, with each of the powers, that the answers are right and wrong where they are. `outcomes`: (lanes, truth) each."""
    totals = [0.0] * len(POWERS)
    for lanes, truth in outcomes:
        for i, power in enumerate(POWERS):
            answer, expected = judged(lanes, power)
            totals[i] += math.log(max(expected if is_right(answer, truth) else 1.0 - expected, 1e-3))
    return totals


def power_of(likelihoods):
    """The power of the greatest likelihood, over the given families."""
    return POWERS[max(range(len(POWERS)), key=lambda i: sum(family[i] for family in likelihoods))]


def loss(answer, truth):
    """Where an answer that is not accurate differs: at the start, inside, or at the far ends only."""
    if any(ours[:1] != theirs[:1] for ours, theirs in zip(answer, truth)):
        return "start"
    for ours, theirs in zip(answer, truth):
        common = min(len(ours), len(theirs))
        tail = common - 1  # the last cone that both have may be swapped
        if ours[:tail] != theirs[:tail]:
            return "inside"
    return "ends"


class Scene:
    """A scene with a truth, in the car's frame."""

    def __init__(self, record, boundaries):
        self.id, self.track, self.rate = record["id"], record["track"], record.get("false_positive_rate", 0.0)
        pose = record["pose"]
        cos, sin = math.cos(pose["yaw"]), math.sin(pose["yaw"])
        moved = {cone["id"]: (cone["x"] - pose["x"], cone["y"] - pose["y"]) for cone in record["cones"]}
        self.all = {cone: (cos * x + sin * y, cos * y - sin * x) for cone, (x, y) in moved.items()}
        order = sorted(self.all, key=lambda cone: math.hypot(*self.all[cone]))
        places = {cone: self.all[cone] for cone in order[:CONTEXT]}
        radius_m = math.hypot(*self.all[order[CONTEXT - 1]]) if len(order) >= CONTEXT else record["range"]
        self.inside = set(order[:NEAREST])
        chains = tuple(tuple(record["ground_truth"][side]) for side in ("left", "right"))
        self.truth = cut(chains, self.inside, self.all)
        by_place = {(round(cone["x"], 2), round(cone["y"], 2)): cone["id"] for cone in record["cones"]}
        full = []
        for chain, side in zip(chains, ("left", "right")):  # without the evening of the far ends, where the boundary goes on
            ids = [by_place.get((round(x, 2), round(y, 2))) for x, y in boundaries[side]]
            chain = list(chain)
            for step in (1, -1):
                at = [i for i in range(len(ids)) if ids[i] == chain[-1] and ids[(i - step) % len(ids)] == chain[-2]]
                following = at[0] + step if at else None
                while following is not None and (boundaries["closed"] or 0 <= following < len(ids)):
                    cone = ids[following % len(ids)]
                    if cone is None or cone in chain:
                        break
                    chain.append(cone)
                    following += step
            end = next((i for i, cone in enumerate(chain) if cone not in places), len(chain))
            full.append(tuple(chain[:end]))
        self.lane = tuple(full)
        self.view = View(places, radius_m, self.rate * len(self.all) / (0.5 * math.pi * record["range"]**2))

    def counts(self):
        return len(self.truth[0]) >= 2 and len(self.truth[1]) >= 2


def read_scenes(path):
    with open(path.replace(".scenes.jsonl", ".tracks.json"), encoding="utf-8") as stream:
        tracks = json.load(stream)
    with open(path, encoding="utf-8") as stream:
        records = [json.loads(line) for line in stream]
    return records, {record["id"]: Scene(record, tracks[record["track"]]) for record in records if record.get("ground_truth")}


def answer_line(scene, method, lane):
    found = bool(lane[0] and lane[1])
    return json.dumps({"scene": scene, "method": method, "status": "found" if found else "none", "left": list(lane[0]) if found else [],
                       "right": list(lane[1]) if found else [], "closed": False, "latency_ms": 0.0, "nearest": NEAREST})


def main(folder):
    suffix = ".scenes.jsonl"
    names = sorted(name.removesuffix(suffix) for name in os.listdir(folder) if name.endswith(suffix))
    families = {name: read_scenes(os.path.join(folder, name + suffix)) for name in names}
    lanes = {}
    for name, (_, scenes) in families.items():
        model = learn([(scene.view, scene.lane) for other, (_, known) in families.items() if other != name
                       for scene in known.values() if scene.rate == 0.0 and scene.counts()])
        lanes[name] = {scene.id: shortened(posterior(model, scene.view, scene.lane), scene.inside, scene.all)
                       for scene in scenes.values() if scene.counts()}
    likelihoods = {name: log_likelihoods([(found, scenes[scene].truth) for scene, found in lanes[name].items()])
                   for name, (_, scenes) in families.items()}
    rows = []
    for name, (records, scenes) in families.items():
        power = power_of([likelihoods[other] for other in names if other != name])
        cells = defaultdict(lambda: defaultdict(float))
        lines = {"judge": [], "truth": []}
        for record in records:
            scene = scenes.get(record["id"])
            answer, truth = ((), ()), ((), ())
            if scene and scene.counts():
                answer, expected = judged(lanes[name][scene.id], power)
                truth = scene.truth
                cell = cells[scene.rate]
                cell["scenes"] += 1
                cell["expected"] += expected
                if is_right(answer, truth):
                    cell["attained"] += 1
                else:
                    cell[loss(answer, truth)] += 1
            lines["judge"].append(answer_line(record["id"], "judge", answer))
            lines["truth"].append(answer_line(record["id"], "truth", truth))
        for kind, answers in lines.items():
            with open(os.path.join(folder, f"{name}.{kind}.lanes.jsonl"), "w", encoding="utf-8") as stream:
                stream.write("\n".join(answers) + "\n")
        for rate, cell in sorted(cells.items()):
            rows.append({"family": name, "rate": rate, "scenes": int(cell["scenes"]), "power": power,
                         "expected": round(cell["expected"] / cell["scenes"], 6), "attained": round(cell["attained"] / cell["scenes"], 6)} |
                        {where: int(cell[where]) for where in ("start", "inside", "ends")})
            print(json.dumps(rows[-1]), flush=True)
    with open(os.path.join(folder, "course_judge.json"), "w", encoding="utf-8") as stream:
        json.dump(rows, stream, indent=1)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    main(sys.argv[1])
