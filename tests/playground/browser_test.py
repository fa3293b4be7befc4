"""browser_test.py PAGE [CHROMIUM]: uses the playground as a person would, in headless Chromium: drags, adds and deletes cones by
mouse, finger and key, moves sliders, opens files, follows a link, drives a lap. Fails on anything that the page reports as an
error. Exit code 77 without Chromium or page."""

import json
import os
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from chromium import Chromium  # noqa: E402

PAGE, CHROMIUM = (sys.argv[1:3] + ["", ""])[:2]
LANE = "JSON.stringify([playground.state.found.front.answer.left, playground.state.found.front.answer.right])"
SHOWN = "playground.whenSettled().then(() => %s)"


class PlaygroundTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = Chromium(CHROMIUM)

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()

    def open(self, width=1400, height=900, is_phone=False, link=""):
        self.browser.problems.clear()
        self.browser.size(width, height, is_phone)
        self.browser.open("file://" + os.path.abspath(PAGE) + link)
        self.browser.wait_for("document.body?.dataset.ready === 'true'")

    def tearDown(self):
        self.assertEqual(self.browser.problems, [])

    def value(self, expression):
        return self.browser.value(expression)

    def settled(self, expression):
        # What an event changes is drawn with the next frame.
        return self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))).then(() => " +
                          SHOWN % expression + ")")

    def place_of_cone(self, place):
        """Where a cone of front's lane is on the screen: [x, y, id]."""
        return self.value(f"""(() => {{ const id = playground.state.found.front.answer.{place};
            const box = document.getElementById("ground").getBoundingClientRect();
            const [x, y] = playground.place(id); return [x + box.left, y + box.top, id]; }})()""")

    def test_tests_itself(self):
        self.open()
        self.browser.wait_for("document.body.dataset.selfTest")
        self.assertEqual(self.value("document.body.dataset.selfTest"), "passed")
        self.assertGreater(float(self.value("document.body.dataset.medianMs")), 0.0)
        self.assertIn("30 lanes of 10 scenes", self.value("document.getElementById('self-test').textContent"))
        loaded = self.value("performance.getEntriesByType('resource').map((one) => one.name)"
                            ".filter((name) => !/^(data|blob):/.test(name))")
        self.assertEqual(loaded, [])

    def test_drags_a_cone_and_sees_another_lane(self):
        self.open()
        before = self.settled(LANE)
        x, y, cone = self.place_of_cone("left[2]")
        self.browser.drag((x, y), (x + 130, y + 90))
        after = self.settled(LANE)
        self.assertNotEqual(before, after)
        self.assertNotIn(cone, json.loads(after)[0])
        self.value("document.getElementById('undo').click()")
        self.assertEqual(self.settled(LANE), before)

    def test_adds_and_deletes_by_click(self):
        self.open()
        count = "playground.state.world.cones.length"
        before = self.value(count)
        self.value("document.querySelector('input[value=add]').click()")
        self.browser.click(700, 760)
        self.assertEqual(self.value(count), before + 1)
        self.value("document.querySelector('input[value=delete]').click()")
        self.browser.click(700, 760)
        self.assertEqual(self.value(count), before)

    def test_keys(self):
        self.open()
        self.value("document.getElementById('ground').focus()")
        self.browser.key("]")
        cone = self.value("playground.state.selected")
        self.assertIsNotNone(cone)
        own = f"playground.state.world.cones.find((one) => one.id === playground.state.selected)"
        before = self.value(f"playground.state.seen.find((one) => one.id === {cone}).x")
        self.browser.key("ArrowRight")
        self.browser.key("ArrowRight")
        self.assertAlmostEqual(self.settled("playground.state.seen.find((one) => one.id === playground.state.selected).x"),
                               before + 0.5, delta=0.2)
        self.assertIsNotNone(self.value(own))
        count = self.value("playground.state.world.cones.length")
        self.browser.key("Delete")
        self.assertEqual(self.value("playground.state.world.cones.length"), count - 1)
        self.browser.key("a")
        self.assertEqual(self.value("playground.state.world.cones.length"), count)
        self.browser.key("2")
        self.assertEqual(self.settled("playground.state.found.clc.answer.status"), "found")

    def test_sliders_change_what_is_seen(self):
        self.open()
        seen = "playground.state.seen.filter((cone) => cone.is_false).length"
        self.value("(() => { const rate = document.getElementById('rate'); rate.value = 0.5; rate.dispatchEvent(new Event('input')); })()")
        many = self.settled(seen)
        total = self.value("playground.state.seen.length")
        self.assertAlmostEqual(many / total, 0.5, delta=0.02)
        self.value("(() => { const rate = document.getElementById('rate'); rate.value = 0; rate.dispatchEvent(new Event('input')); })()")
        self.assertEqual(self.settled(seen), 0)

    def test_explains_the_exact_solver(self):
        self.open()
        self.browser.key("3")
        self.value("playground.turn('rld-pair', true)")
        self.settled("1")
        text = self.value("document.getElementById('method-rld-pair').textContent")
        self.assertIn("objective", text)
        self.assertIn("proven", text)
        place = self.value("""(() => { const id = playground.state.found["rld-pair"].answer.left[1];
            const box = document.getElementById("ground").getBoundingClientRect();
            const [x, y] = playground.place(id); return [x + box.left, y + box.top, id]; })()""")
        self.browser.mouse("mouseMoved", place[0], place[1])
        self.browser.wait_for(f"document.getElementById('explanation').dataset.about === '{place[2]}'")
        words = self.value("document.getElementById('explanation').textContent")
        self.assertIn("left boundary", words)
        self.assertRegex(words, r"Cheapest change: .* costs \+|cannot be spared")

    def test_a_link_holds_the_scene(self):
        self.open()
        x, y, _ = self.place_of_cone("left[1]")
        self.browser.drag((x, y), (x + 60, y + 60))
        self.value("playground.turn('clc', true)")
        before = self.settled(LANE)
        cones = self.value("JSON.stringify(playground.state.seen.map(({id}) => id).sort())")
        link = self.value("playground.save().then(() => location.hash)")
        self.assertLess(len(link), 4000)
        self.open(link=link)
        self.assertEqual(self.value("JSON.stringify(playground.state.seen.map(({id}) => id).sort())"), cones)
        self.assertTrue(self.value("playground.state.methods.clc"))
        self.assertEqual(self.settled(LANE), before)

    def test_a_broken_link_is_said(self):
        self.open(link="#1.broken")
        self.assertIn("link is broken", self.value("document.getElementById('error').textContent"))

    def test_opens_files_and_plays_them(self):
        self.open()
        scene = {"id": "one", "pose": {"x": 0, "y": 0, "yaw": 0},
                 "cones": [{"id": 2 * i + side, "x": 4.0 * i + 1, "y": 1.8 if side else -1.8} for i in range(8) for side in (0, 1)]}
        text = json.dumps(scene) + "\n" + json.dumps({**scene, "id": "two", "pose": {"x": 4, "y": 0, "yaw": 0}}) + "\n"
        lanes = json.dumps({"scene": "two", "method": "mine", "left": [3, 5, 7], "right": [2, 4, 6]}) + "\n"
        self.value(f"""playground.openFiles([new File([{json.dumps(text)}], "s.scenes.jsonl"),
                                             new File([{json.dumps(lanes)}], "mine.lanes.jsonl")]).catch(() => 0)""")
        self.assertEqual(self.settled("playground.state.found.front.answer.left.join()"), "1,3,5,7,9,11,13,15")
        self.value("document.getElementById('play').click()")
        self.browser.wait_for("playground.state.file.at === 1 && document.body.dataset.playing === 'false'")
        self.assertEqual(self.value("playground.state.file_lanes[0].method"), "mine")
        self.value("""playground.openFiles([new File(['{"pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": "a"}]}'], "bad.jsonl")])
                   .catch((error) => { window.refused = error.message; })""")
        self.assertEqual(self.value("window.refused"), "bad.jsonl:1: cones[0].x: must be a finite number")

    def test_drives_a_lap(self):
        self.open()
        self.value("(() => { const speed = document.getElementById('speed'); speed.value = '4'; })()")
        self.value("document.getElementById('play').click()")
        self.browser.wait_for("playground.state.run?.driven_m > 5", 60)
        self.assertGreater(self.value("playground.state.seen.length"), 5)
        self.browser.wait_for("document.body.dataset.run && document.body.dataset.run !== 'driving'", 150)
        self.assertEqual(self.value("document.body.dataset.run"), "finished", self.value("document.getElementById('run-state').textContent"))

    def test_an_error_is_shown_and_the_module_starts_anew(self):
        self.open()
        message = self.value("""playground.ask("centreLine", { scene: { pose: { x: 0, y: 0, yaw: 0 }, cones: [{ id: 1, x: 1, y: 1 }] },
            lane: { left: [1, 1], right: [1], closed: false } }).catch((error) => error.message)""")
        self.assertIn("left[1]", message)
        self.assertIn("started again", self.value("document.getElementById('error').textContent"))
        self.assertFalse(self.value("document.getElementById('error').hidden"))
        self.assertEqual(self.value("document.body.dataset.restarts"), "1")
        self.value("playground.turn('clc', true)")
        self.assertEqual(self.settled("playground.state.found.clc.answer.status"), "found")

    def test_phone(self):
        self.open(400, 800, is_phone=True)
        self.assertLessEqual(self.value("document.documentElement.scrollWidth"), 400)
        before = self.settled(LANE)
        x, y, _ = self.place_of_cone("left[2]")
        self.browser.touch("touchStart", (x, y))
        for i in range(1, 11):
            self.browser.touch("touchMove", (x + 5 * i, y + 5 * i))
        self.browser.touch("touchEnd")
        self.assertNotEqual(self.settled(LANE), before)
        scale = self.value("playground.view.scale")
        self.browser.touch("touchStart", (150, 200), (200, 250))
        self.browser.touch("touchMove", (100, 150), (250, 300))
        self.browser.touch("touchEnd")
        self.assertGreater(self.value("playground.view.scale"), scale * 1.2)
        small = self.value("""[...document.querySelectorAll("button, select")].filter((one) => one.offsetParent !== null)
            .filter((one) => one.getBoundingClientRect().height < 28).map((one) => one.id)""")
        self.assertEqual(small, [])

    def test_its_picture_is_made_by_the_script(self):
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "playground", "screenshot")
        with tempfile.TemporaryDirectory() as folder:
            picture = os.path.join(folder, "page.png")
            done = subprocess.run([sys.executable, script, PAGE, picture, "--width", "640", "--height", "480"], check=False,
                                  capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            with open(picture, "rb") as stream:
                head = stream.read(24)
        self.assertEqual(head[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual([int.from_bytes(head[i:i + 4], "big") for i in (16, 20)], [640, 480])

    def test_theme(self):
        self.open()
        ground = "getComputedStyle(document.body).backgroundColor"
        before = self.value(ground)
        self.value("document.getElementById('theme').click()")
        self.assertNotEqual(self.value(ground), before)


if __name__ == "__main__":
    if not os.access(CHROMIUM, os.X_OK):
        print("skipped: there is no Chromium (Debian: apt-get install chromium)")
        sys.exit(77)
    if not os.path.exists(PAGE):
        print("skipped: the page was not built, since packages of [playground] in .ci/packages.txt are missing")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
