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

A place is a complex number, ahead + left * i, in metres; a lane is a pair of tuples of cones, left and right.
"""

import cmath
import json
import math
import os
import random
import sys
from collections import Counter, defaultdict
from dataclasses import dataclass

import numpy as np
from cells import lines_of, read_json, rounded

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
    """Density of a place given features: a mixture of normal distributions around a linear regression."""

    def __init__(self, weights, components):
        self.weights = np.array(weights)  # a row for x, a row for y
        self.components = [(share, np.array(mean), np.array(covariance)) for share, mean, covariance in components]
        self.forms = []
        for share, (x, y), ((xx, xy), (_, yy)) in self.components:
            det = xx * yy - xy * xy
            self.forms.append((share / (2 * math.pi * math.sqrt(det)), complex(x, y), -0.5 * yy / det, xy / det, -0.5 * xx / det))
        source = random.Random(1)
        self.residuals = [self.draw(source) for _ in range(48)]

    def draw(self, source):
        _, mean, covariance = source.choices(self.components, [component[0] for component in self.components])[0]
        return complex(*(mean + np.linalg.cholesky(covariance) @ (source.gauss(0, 1), source.gauss(0, 1))))

    def mean(self, features):
        return complex(*(self.weights @ features))

    def log(self, residual):
        total = 0.0
        for scale, mean, xx, xy, yy in self.forms:
            u, v = (residual - mean).real, (residual - mean).imag
            total += scale * math.exp(xx * u * u + xy * u * v + yy * v * v)
        return math.log(max(total, 1e-30))


def fitted(features, targets):
    """The density of the targets given the features, by least squares and expectation maximisation."""
    features = np.array(features)
    targets = np.column_stack([np.real(targets), np.imag(targets)])
    weights = np.linalg.solve(features.T @ features + 1e-3 * np.eye(features.shape[1]), features.T @ targets).T
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
    return Density(weights, [((1 - STRAY[0]) * share, mean, cov) for share, mean, cov in parts] + [(STRAY[0], np.zeros(2), STRAY[1] * np.eye(2))])


@dataclass
class View:
    """The nearest cones ahead of the car, in its frame; `radius_m`: they are all cones up to there."""

    places: dict
    radius_m: float
    false_density: float

    def contains(self, place):
        return place.real >= 0.0 and abs(place) <= self.radius_m


def direction(a, b):
    return (b - a) / (abs(b - a) or 1e-9)


def cross(a, b):
    return (a.conjugate() * b).imag


def points_of(chain, places):
    """The last three places of a boundary; places behind the car stand for cones that are not there."""
    known = [places[cone] for cone in chain[-3:]]
    return [known[0] - VIRTUAL_M * missing for missing in range(3 - len(known), 0, -1)] + known


def side_to_grow(lane, ended, places):
    """0 left, 1 right, None: the lane is complete."""
    if not lane[0] or not lane[1]:
        return 0 if not lane[0] else 1
    if ended[0] or ended[1]:
        return None if all(ended) else int(ended[0])
    left, right = points_of(lane[0], places), points_of(lane[1], places)
    ahead = direction(left[1], left[2]) + direction(right[1], right[2])
    return 0 if ((left[2] - right[2]) * ahead.conjugate()).real <= 0.0 else 1


class Context:
    """Where the next cone of a boundary is looked for: the kind of the density, its features, and the frame of its targets. In the frame, x is
    along the last edge and the other boundary is at positive y."""

    def __init__(self, lane, side, ended, places):
        self.is_left, other = side == 0, lane[1 - side]
        if not lane[side]:
            self.origin, self.ahead = 0j, 1 + 0j
            self.kind, self.features = "first", (1.0,)
            if other:
                facing = self.local(places[other[0]])
                self.kind, self.features = "facing", (1.0, facing.real, facing.imag)
            return
        before, last_but_one, self.origin = points_of(lane[side], places)
        self.ahead, length = direction(last_but_one, self.origin), abs(self.origin - last_but_one)
        _, facing_before, facing = points_of(other, places)
        sign, place = -1.0 if self.is_left else 1.0, self.local(facing)
        turn, slant = sign * cross(direction(before, last_but_one), self.ahead), sign * cross(self.ahead, direction(facing_before, facing))
        if ended[1 - side] or abs(place.real) > 8.0 or not 0.0 < place.imag < 9.0:
            self.kind, self.features = "alone", (1.0, length, turn)
        elif len(lane[side]) == 1:
            self.kind, self.features = "second", (1.0, place.real, place.imag, slant)
        else:
            self.kind, self.features = "next", (1.0, length, turn, place.real, place.imag, slant, length * turn, length * slant)

    def mirrored(self, place):
        return place.conjugate() if self.is_left else place

    def local(self, place):
        return self.mirrored((place - self.origin) * self.ahead.conjugate())

    def place(self, local):
        return self.origin + self.ahead * self.mirrored(local)


def decisions(lane, places):
    """What the growth of a lane decides: (context, cone or None for an end)."""
    grown, ended = ([], []), [False, False]
    while (side := side_to_grow(grown, ended, places)) is not None:
        context, index = Context(grown, side, ended, places), len(grown[side])
        cone = lane[side][index] if index < len(lane[side]) else None
        yield context, cone
        if cone is None:
            ended[side] = True
        else:
            grown[side].append(cone)


@dataclass
class Model:
    densities: dict
    early_end: float  # probability that a boundary ends although its next cone would be in view
    beside: float = 0.0  # true cones of no boundary of the lane, for each m², beside the lane and far from it
    far: float = 0.0

    def out_of_view(self, context, mean, view):
        place = context.place(mean)
        if min(place.real, view.radius_m - abs(place)) > 8.0:
            return 0.0
        residuals = self.densities[context.kind].residuals
        return sum(not view.contains(context.place(mean + residual)) for residual in residuals) / len(residuals)

    def options(self, context, view):
        """Log weight of each next cone and, under None, of the end; a cone counts against a uniform one."""
        density = self.densities[context.kind]
        mean = density.mean(context.features)
        can_end = context.kind not in ("first", "facing")
        stay = math.log(1.0 - self.early_end) if can_end else 0.0
        found = {cone: stay + density.log(local - mean) - math.log(self.far + view.false_density) for cone, place in view.places.items()
                 if abs(local := context.local(place)) <= REACH_M}
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
    return number, 2 * BESIDE_M * sum(abs(b - a) for line in lines for a, b in zip(line, line[1:]))


def learn(examples):
    """The model of views without false cones, with their lanes."""
    features, targets, ending = defaultdict(list), defaultdict(list), []
    near, far, near_m2, far_m2 = 1.0, 1.0, 1e3, 1e3  # as if one cone had been seen
    for view, lane in examples:
        for context, cone in decisions(lane, view.places):
            if cone is None:
                ending.append((context, view))
            else:
                features[context.kind].append(context.features)
                targets[context.kind].append(context.local(view.places[cone]))
        number, area_m2 = beside(lane, view)
        near += number
        near_m2 += area_m2
        far += len(view.places) - len(lane[0]) - len(lane[1]) - number
        far_m2 += max(0.0, 0.5 * math.pi * view.radius_m**2 - area_m2)
    model = Model({kind: fitted(features[kind], targets[kind]) for kind in features}, 0.5, near / near_m2, far / far_m2)
    # The share of the ends that the view does not explain.
    ends = 1.0 + sum(1.0 - model.out_of_view(context, model.densities[context.kind].mean(context.features), view) for context, view in ending)
    model.early_end = ends / (ends + 50.0 + sum(map(len, targets.values())))
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

    def replaced(pair, side, value):
        return (value, pair[1]) if side == 0 else (pair[0], value)

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
                    grown.append((score + weight, lane, replaced(ended, side, True)))
                elif cone not in lane[0] and cone not in lane[1]:
                    grown.append((score + weight, replaced(lane, side, lane[side] + (cone,)), ended))
        beam = sorted(grown, key=lambda state: -state[0])[:BEAM]
    if also is not None and also not in complete:
        complete[also] = model.log_of_others(also, view) + sum(model.options(context, view).get(cone, -60.0)
                                                               for context, cone in decisions(also, view.places))
    kept = dict(sorted(complete.items(), key=lambda item: -item[1])[:KEPT])
    if also is not None:
        kept.setdefault(also, complete[also])
    best = max(complete.values())
    total = sum(math.exp(score - best) for score in kept.values())
    return [(lane, math.exp(score - best) / total) for lane, score in kept.items()]


def distance_m(place, line):
    def to_edge(a, b):
        along = ((place - a) * (b - a).conjugate()).real / (abs(b - a)**2 or 1e-12)
        return abs(place - a - min(1.0, max(0.0, along)) * (b - a))
    return min((to_edge(a, b) for a, b in zip(line, line[1:])), default=abs(place - line[0]))


def cut(lane, inside, places):
    """The lane up to the first cone that is not inside, with even far ends; as model/lane.cpp."""
    sides = [list(chain[:next((i for i, cone in enumerate(chain) if cone not in inside), len(chain))]) for chain in lane]
    while sides[0] and sides[1]:
        lines = [[places[cone] for cone in side] for side in sides]
        far = [distance_m(lines[i][-1], lines[1 - i]) > WIDEST_M for i in (0, 1)]
        if not any(far):
            break
        sides[0 if far[0] else 1].pop()
    return tuple(sides[0]), tuple(sides[1])


def counts(lane):
    """Only lanes with two cones a side count."""
    return len(lane[0]) >= 2 and len(lane[1]) >= 2


def shortened(lanes, inside, places):
    """The lanes of the cones inside."""
    return [(short, probability) for lane, probability in lanes if counts(short := cut(lane, inside, places))]


def judged(lanes, power=1.0):
    """The answer that has at most one wrong cone with the highest probability, and that probability."""
    mass = defaultdict(float)
    for lane, probability in lanes:
        mass[lane] += probability**power
    if not mass:
        return ((), ()), 0.0

    def value(answer):
        return sum(p for lane, p in mass.items() if is_right(answer, lane)) / sum(mass.values())
    best = max(sorted(mass, key=lambda lane: -mass[lane])[:30], key=value)
    return best, value(best)


def is_right(answer, truth):
    return len(set(answer[0] + answer[1]) ^ set(truth[0] + truth[1])) <= 1


def log_likelihoods(outcomes):
    """How likely it is, with each of the powers, that the answers are right and wrong where they are. `outcomes`: (lanes, truth) each."""
    def log(lanes, truth, power):
        answer, expected = judged(lanes, power)
        return math.log(max(expected if is_right(answer, truth) else 1.0 - expected, 1e-3))
    return [sum(log(*outcome, power) for outcome in outcomes) for power in POWERS]


def power_of(likelihoods):
    """The power of the greatest likelihood, over the given families."""
    return POWERS[max(range(len(POWERS)), key=lambda i: sum(family[i] for family in likelihoods))]


def loss(answer, truth):
    """Where an answer that is not accurate differs: at the start, inside, or at the far ends only."""
    if any(ours[:1] != theirs[:1] for ours, theirs in zip(answer, truth)):
        return "start"
    for ours, theirs in zip(answer, truth):
        tail = min(len(ours), len(theirs)) - 1  # the last cone that both have may be swapped
        if ours[:tail] != theirs[:tail]:
            return "inside"
    return "ends"


class Scene:
    """A scene with a truth, in the car's frame."""

    def __init__(self, record, boundaries):
        self.id, self.rate = record["id"], record.get("false_positive_rate", 0.0)
        pose, range_m = record["pose"], record["range"]
        self.all = {cone["id"]: (complex(cone["x"], cone["y"]) - complex(pose["x"], pose["y"])) * cmath.exp(-1j * pose["yaw"])
                    for cone in record["cones"]}
        order = sorted(self.all, key=lambda cone: abs(self.all[cone]))
        places = {cone: self.all[cone] for cone in order[:CONTEXT]}
        self.inside = set(order[:NEAREST])
        chains = [record["ground_truth"][side] for side in ("left", "right")]
        self.truth = cut(chains, self.inside, self.all)
        self.counts = counts(self.truth)
        by_place = {(round(cone["x"], 2), round(cone["y"], 2)): cone["id"] for cone in record["cones"]}
        full = []
        for chain, side in zip(chains, ("left", "right")):
            whole = onward(chain, [by_place.get((round(x, 2), round(y, 2))) for x, y in boundaries[side]], boundaries["closed"])
            full.append(tuple(whole[:next((i for i, cone in enumerate(whole) if cone not in places), len(whole))]))
        self.lane = tuple(full)
        self.view = View(places, abs(self.all[order[CONTEXT - 1]]) if len(order) >= CONTEXT else range_m,
                         self.rate * len(self.all) / (0.5 * math.pi * range_m**2))


def onward(chain, boundary, is_closed):
    """The chain without the evening of its far end, where the boundary of the course goes on."""
    chain, size = list(chain), len(boundary)
    for step in (1, -1):
        at = [i for i in range(size) if boundary[i] == chain[-1] and boundary[(i - step) % size] == chain[-2]]
        following = at[0] + step if at else None
        while following is not None and (is_closed or 0 <= following < size):
            cone = boundary[following % size]
            if cone is None or cone in chain:
                break
            chain.append(cone)
            following += step
    return chain


def read_scenes(path):
    """The ids of all scenes, and those with a truth by their id."""
    tracks, records = read_json(path.replace(".scenes.jsonl", ".tracks.json")), lines_of(path)
    return [record["id"] for record in records], {record["id"]: Scene(record, tracks[record["track"]]) for record in records if record.get("ground_truth")}


def answer_line(scene, method, lane):
    found = bool(lane[0] and lane[1])
    left, right = lane if found else ((), ())
    return json.dumps({"scene": scene, "method": method, "status": "found" if found else "none", "left": left, "right": right, "closed": False,
                       "latency_ms": 0.0, "nearest": NEAREST}) + "\n"


def main(folder):
    def place(name, suffix):
        return os.path.join(folder, f"{name}.{suffix}")

    names = sorted(name.removesuffix(".scenes.jsonl") for name in os.listdir(folder) if name.endswith(".scenes.jsonl"))
    ids, scenes = {}, {}
    for name in names:
        ids[name], known = read_scenes(place(name, "scenes.jsonl"))
        scenes[name] = {scene: one for scene, one in known.items() if one.counts}
    lanes, likelihoods, rows = {}, {}, []
    for name in names:
        model = learn([(scene.view, scene.lane) for other in names if other != name for scene in scenes[other].values() if scene.rate == 0.0])
        lanes[name] = {scene.id: shortened(posterior(model, scene.view, scene.lane), scene.inside, scene.all) for scene in scenes[name].values()}
        likelihoods[name] = log_likelihoods([(found, scenes[name][scene].truth) for scene, found in lanes[name].items()])
    for name in names:
        power = power_of([likelihoods[other] for other in names if other != name])
        answers = {scene: judged(found, power) for scene, found in lanes[name].items()}
        truths = {scene: (one.truth, 1.0) for scene, one in scenes[name].items()}
        for method, given in (("judge", answers), ("truth", truths)):
            with open(place(name, f"{method}.lanes.jsonl"), "w", encoding="utf-8") as stream:
                stream.writelines(answer_line(scene, method, given.get(scene, (((), ()), 0.0))[0]) for scene in ids[name])
        for rate in sorted({scene.rate for scene in scenes[name].values()}):
            of_rate = [scene for scene in scenes[name].values() if scene.rate == rate]
            where = Counter("attained" if is_right(answers[scene.id][0], scene.truth) else loss(answers[scene.id][0], scene.truth) for scene in of_rate)
            rows.append({"family": name, "rate": rate, "scenes": len(of_rate), "power": power,
                         "expected": rounded(sum(answers[scene.id][1] for scene in of_rate) / len(of_rate)),
                         "attained": rounded(where["attained"] / len(of_rate))} | {key: where[key] for key in ("start", "inside", "ends")})
            print(json.dumps(rows[-1]), flush=True)
    with open(os.path.join(folder, "course_judge.json"), "w", encoding="utf-8") as stream:
        json.dump(rows, stream, indent=1)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    main(sys.argv[1])
