"""course_judge_test.py ROOT: the judge of experiments/tables/course_judge.py on instances that can be followed by hand, and on lanes that its own model
draws. Exit code 77 without numpy."""

import math
import os
import random
import sys
import unittest

ROOT = sys.argv.pop(1)
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "experiments", "tables"))

try:
    import course_judge
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)


def normal(weights, variance):
    return course_judge.Density(weights, [(1.0, (0.0, 0.0), ((variance, 0.0), (0.0, variance)))])


def straight_model(variance, early_end=0.01):
    """A straight lane 4 m wide, with a cone every 4 m from 2 m ahead of the car on."""
    onward = [[4.0], [0.0]]
    return course_judge.Model({"first": normal([[2.0], [-2.0]], variance), "facing": normal([[2.0, 0.0, 0.0], [-2.0, 0.0, 0.0]], variance),
                          "second": normal([row + [0.0] * 3 for row in onward], variance),
                          "next": normal([row + [0.0] * 7 for row in onward], variance),
                          "alone": normal([row + [0.0] * 2 for row in onward], variance)}, early_end)


LEFT, RIGHT = (1, 2, 3), (11, 12, 13)
COURSE = {1: complex(2.0, 2.0), 2: complex(6.0, 2.0), 3: complex(10.0, 2.0), 11: complex(2.0, -2.0), 12: complex(6.0, -2.0), 13: complex(10.0, -2.0)}


class Judge(unittest.TestCase):
    def probabilities(self, places, clutter, variance=0.1):
        view = course_judge.View(places, 12.0, clutter)
        return dict(course_judge.posterior(straight_model(variance), view))

    def test_without_a_rival_the_lane_is_sure(self):
        self.assertGreater(self.probabilities(COURSE, 1e-3)[LEFT, RIGHT], 0.99)

    def test_two_cones_at_the_same_distance_from_the_continuation_have_one_half_each(self):
        # Instead of cone 3 there are two, 0.5 m to both sides of its place: which one is false cannot be told.
        places = {cone: place for cone, place in COURSE.items() if cone != 3} | {3: 10.0 + 2.5j, 99: 10.0 + 1.5j}
        lanes = self.probabilities(places, 1e-3)
        self.assertAlmostEqual(lanes[LEFT, RIGHT], lanes[(1, 2, 99), RIGHT], places=9)
        self.assertGreater(lanes[LEFT, RIGHT] + lanes[(1, 2, 99), RIGHT], 0.98)

    def test_the_odds_of_a_cone_are_those_of_the_densities(self):
        # The far cone is exactly where the next one is expected, but a boundary may end early. Odds for it:
        # (1 - early_end) / (2 pi variance) / clutter, against early_end plus the share beyond the view, which is 0 here.
        # What follows in both cases, the end of this boundary, differs: from the far cone the next one is out of view.
        variance, clutter = 0.01, 0.4
        lanes = self.probabilities(COURSE, clutter, variance)
        with_it, without = lanes[LEFT, RIGHT], lanes[(1, 2), RIGHT]
        by_hand = 0.99 / (2 * math.pi * variance) / clutter / 0.01
        self.assertAlmostEqual(with_it / without, by_hand, delta=1e-6 * by_hand)

    def test_the_answer_may_have_one_wrong_cone(self):
        # Two lanes differ by one cone: either answer is accurate for both. A third one differs by two from each.
        lanes = [((LEFT, RIGHT), 0.3), (((1, 2), RIGHT), 0.3), (((1, 98, 99), RIGHT), 0.4)]
        places = COURSE | {98: 6.0 + 2.5j, 99: 10.0 + 2.5j}
        answer, probability = course_judge.judged(course_judge.shortened(lanes, set(places), places))
        self.assertIn(answer, [(LEFT, RIGHT), ((1, 2), RIGHT)])
        self.assertAlmostEqual(probability, 0.6)

    def test_a_lane_is_cut_as_by_the_detector(self):
        self.assertEqual(course_judge.cut((LEFT, RIGHT), {1, 3, 11, 12}, COURSE), ((1,), (11, 12)))
        places = COURSE | {3: 16.0 + 2.0j}  # farther than 6.5 m from the last cone on the right
        self.assertEqual(course_judge.cut((LEFT, (11, 12)), set(places), places), ((1, 2), (11, 12)))

    def test_where_an_answer_differs(self):
        truth = ((1, 2, 3), (11, 12, 13))
        self.assertEqual(course_judge.loss(((1, 2, 99), (11, 12, 13, 98)), truth), "ends")
        self.assertEqual(course_judge.loss(((1, 99, 3), (11, 12, 13)), truth), "inside")
        self.assertEqual(course_judge.loss(((99, 2, 3), (11, 12, 13)), truth), "start")

    def test_cones_beside_the_lane_count_by_their_own_density(self):
        view = course_judge.View(COURSE | {98: 8.0 + 4.0j, 99: 8.0 + 8.0j}, 12.0, 0.01)
        number, area_m2 = course_judge.beside((LEFT, RIGHT), view)
        self.assertEqual(number, 1)  # cone 98, 2 m from the left boundary
        self.assertAlmostEqual(area_m2, 2 * 8.0 * 2 * course_judge.BESIDE_M)
        model = straight_model(0.1)
        model.beside, model.far = 0.0, 0.03
        self.assertAlmostEqual(model.log_of_others((LEFT, RIGHT), view), math.log(0.25) + 0.03 * area_m2)

    def test_the_power_allows_for_answers_that_are_wrong_too_often(self):
        wrong = ((1, 98, 99), (11, 12))
        lanes = [((LEFT, RIGHT), 0.99), (wrong, 0.01)]
        always_right = course_judge.log_likelihoods([(lanes, (LEFT, RIGHT))] * 3)
        often_wrong = course_judge.log_likelihoods([(lanes, (LEFT, RIGHT))] * 6 + [(lanes, wrong)] * 4)
        self.assertEqual(course_judge.power_of([always_right]), 1.0)
        self.assertEqual(course_judge.power_of([often_wrong]), course_judge.POWERS[-1])
        self.assertEqual(course_judge.power_of([always_right, often_wrong]), course_judge.POWERS[-1])


class Fit(unittest.TestCase):
    def test_a_regression_and_its_spread_are_found(self):
        source = random.Random(3)
        features = [(1.0, source.uniform(3, 5)) for _ in range(4000)]
        targets = [complex(f[1] + source.gauss(0, 0.3), 0.5 + source.gauss(0, 0.1)) for f in features]
        density = course_judge.fitted(features, targets)
        self.assertAlmostEqual(density.mean((1.0, 4.0)), 4.0 + 0.5j, delta=0.03)
        variance = [0.3**2 + course_judge.SMOOTHING_M2, 0.1**2 + course_judge.SMOOTHING_M2]
        at_mean = math.log((1 - course_judge.STRAY[0]) / (2 * math.pi * math.sqrt(variance[0] * variance[1])))
        self.assertAlmostEqual(density.log(0.0), at_mean, delta=0.1)


class Calibration(unittest.TestCase):
    def drawn(self, model, source, clutter):
        """A view with a lane of the model and uniform other cones, of the clutter's density."""
        view = course_judge.View({}, 14.0, clutter)
        lane, ended, cone = ([], []), [False, False], 0
        while (side := course_judge.side_to_grow(lane, ended, view.places)) is not None:
            context = course_judge.Context(lane, side, ended, view.places)
            density = model.densities[context.kind]
            mean = density.mean(context.features)
            place = context.place(mean + density.draw(source))
            if lane[0] and lane[1] and (source.random() < model.early_end or not view.contains(place)):
                ended[side] = True
            else:
                cone += 1
                view.places[cone] = place
                lane[side].append(cone)
        expected_count = clutter * 0.5 * math.pi * view.radius_m**2
        number = sum(source.random() < expected_count / 1000 for _ in range(1000))
        while number:
            place = complex(source.uniform(0, view.radius_m), source.uniform(-view.radius_m, view.radius_m))
            if view.contains(place):
                cone += 1
                view.places[cone] = place
                number -= 1
        return view, (tuple(lane[0]), tuple(lane[1]))

    def test_the_judge_is_right_as_often_as_it_expects(self):
        source = random.Random(5)
        model = straight_model(0.15, 0.05)
        expected, attained, scenes = 0.0, 0, 0
        while scenes < 300:
            view, lane = self.drawn(model, source, 0.1)
            lane = course_judge.cut(lane, set(view.places), view.places)
            if len(lane[0]) < 2 or len(lane[1]) < 2:
                continue  # such scenes are not counted, and the judge knows that
            answer, probability = course_judge.judged(course_judge.shortened(course_judge.posterior(model, view), set(view.places), view.places))
            expected += probability
            attained += course_judge.is_right(answer, lane)
            scenes += 1
        self.assertLess(expected / scenes, 0.95)  # otherwise there is nothing to see
        deviation = math.sqrt(expected / scenes * (1 - expected / scenes) / scenes)
        self.assertLess(abs(expected - attained) / scenes, 3 * deviation, f"expected {expected}, attained {attained} of {scenes}")


if __name__ == "__main__":
    unittest.main()
