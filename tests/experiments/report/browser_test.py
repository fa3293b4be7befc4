"""browser_test.py PAGE [CHROMIUM]: uses the page as a reader would, in headless Chromium: plays the viewer, turns
methods off, sorts, filters, changes the theme. Fails on anything the page reports as an error. Exit code 77 without
Chromium."""

import json
import os
import re
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "support"))
from chromium import Chromium  # noqa: E402

WATCH = """<script>
const problems = [];
// Every line that is drawn, with its dashes.
const strokes = { lines: [], points: [] };
const contexts = CanvasRenderingContext2D.prototype;
const observe = (name, before) => {
  const original = contexts[name];
  contexts[name] = function (...values) { before.call(this, ...values); return original.apply(this, values); };
};
observe("beginPath", () => { strokes.points = []; });
observe("moveTo", (x, y) => strokes.points.push([x, y]));
observe("lineTo", (x, y) => strokes.points.push([x, y]));
observe("stroke", function () {
  strokes.lines.push({ canvas: this.canvas.id, element: this.canvas, dash: this.getLineDash().join(), width: this.lineWidth, style: this.strokeStyle, points: strokes.points });
});
</script>"""

USE = """<script>
addEventListener("load", async () => {
  const check = (holds, what) => { if (!holds) problems.push("not so: " + what); };
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const box = document.getElementById("viewer"), scene = document.getElementById("view-scene");
  const key = (name) => box.dispatchEvent(new KeyboardEvent("keydown", { key: name, bubbles: true }));
  const pixels = () => scene.toDataURL();
  const pose = () => Number(document.getElementById("view-pose").value);
  const last = () => Number(document.getElementById("view-pose").max);
  try {
    const rows = [...document.querySelectorAll("#headline tbody tr")];
    if (innerWidth >= 1280) {
      check(rows.length === 3 && rows[2].getBoundingClientRect().bottom < innerHeight, "the first screen has the whole table");
      const cut = [...document.querySelectorAll("#headline .scroll, #by-rate .scroll, #quality .scroll, #latencies .scroll")]
        .filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.parentElement.id);
      check(cut.length === 0, "no main table is cut off at the side: " + cut);
    }
    const narrow = [...document.querySelectorAll("#methods figure")].filter((one) => one.getBoundingClientRect().width < 150);
    check(narrow.length === 0, "the pictures of the methods have room");
    check(document.querySelector("#cone-lane canvas").getBoundingClientRect().height > 80, "what a cone lane is, is shown");
    const sorter = document.querySelector("#headline thead button");
    sorter.focus();
    check(document.activeElement === sorter, "a column's title takes the focus of the keyboard");
    sorter.click();
    check(sorter.parentElement.getAttribute("aria-sort") === "ascending", "and sorts, which is said");
    for (const link of document.querySelectorAll("nav a"))
      check(document.querySelector(link.getAttribute("href")), "the link leads to " + link.textContent);
    box.focus();
    check(document.activeElement === box, "the viewer takes the keyboard");
    const toggles = [...document.querySelectorAll("#view-methods input")];
    check(toggles.length === 3, "every method has a toggle");
    check(toggles.map((toggle) => toggle.checked).join() === "true,false,false", "the best method alone is on at first");
    const redrawn = () => { strokes.lines = []; dispatchEvent(new Event("resize")); return strokes.lines; };
    const hex = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const { frames } = JSON.parse(document.getElementById("scene-data").textContent);
    const pictures = [...document.querySelectorAll("canvas[data-slot]")];
    document.dispatchEvent(new Event("themechange"));
    const empty = pictures.filter((canvas) => {
      const answer = frames[canvas.dataset.scene].a[canvas.dataset.slot];
      const lane = strokes.lines.filter((line) => line.element === canvas && line.style === hex("--left") && line.points.length > 1);
      return answer && answer[0].length > 1 && lane.length === 0;
    });
    check(pictures.length > 3 && empty.length === 0, "each small picture shows its lane: " + empty.map((canvas) => canvas.dataset.scene));
    const drawnIn = (name) => redrawn().some((line) => line.canvas === "view-scene" && line.style === hex(name) && line.points.length > 2);
    check(drawnIn("--left") && drawnIn("--right"), "its boundaries have two colours");
    for (const toggle of toggles.slice(1)) toggle.click();
    check(!drawnIn("--left") && !drawnIn("--right"), "with several on each has that of its method");

    const rowsOf = document.querySelector("#quality .scroll"), cue = rowsOf.querySelector(".cue");
    rowsOf.style.maxHeight = "12rem"; // a table of this small comparison fits otherwise
    dispatchEvent(new Event("resize"));
    check(/↓ \d+ more row/.test(cue.textContent) && !cue.hidden, "that a table goes on below is said: " + cue.textContent);
    rowsOf.scrollTop = rowsOf.scrollHeight;
    await wait(100);
    check(!cue.textContent.includes("↓"), "until its end is seen");
    rowsOf.scrollTop = 0;
    rowsOf.style.maxHeight = "";
    await wait(100);

    const track = document.getElementById("view-track");
    track.value = "circle";
    track.dispatchEvent(new Event("change"));
    const slider = document.getElementById("view-pose");
    slider.value = 1;
    slider.dispatchEvent(new Event("input"));
    strokes.lines = [];
    slider.value = 0;
    slider.dispatchEvent(new Event("input"));
    check(box.dataset.scene.startsWith("circle/"), "the chosen track is shown");

    const marks = JSON.parse(document.getElementById("marks").textContent);
    const answers = frames[box.dataset.scene].a; // see with_uncertain_answers
    const lines = () => strokes.lines.filter((line) => line.canvas === "view-scene");
    const inferred = lines().filter((line) => line.dash === marks.inferred.dash.join());
    check(inferred.length === 1 && inferred[0].points.length === answers[0][0].length,
          "beside a boundary that is known alone another one is drawn");
    const across = (line) => line.dash === "" && Math.abs(line.width - marks.trusted.width) < 1e-6 && line.points.length === 2;
    check(lines().filter(across).length === 1, "a line across the lane that has a trusted length");

    const before = pixels(), name = box.dataset.scene;
    document.getElementById("view-next").click();
    check(pose() === 1 && box.dataset.scene !== name, "the button goes to the next pose");
    check(pixels() !== before, "another pose looks different");
    key("ArrowLeft");
    check(pose() === 0 && pixels() === before, "the arrow goes back");

    for (const toggle of toggles) toggle.click();
    const bare = pixels();
    check(bare !== before, "lanes can be turned off");
    key("3");
    check(pixels() !== bare && toggles[2].checked, "a digit turns one on");
    for (const toggle of toggles.slice(0, 2)) toggle.click();
    check(pixels() === before, "and all are back");

    const rate = document.getElementById("view-rate");
    rate.selectedIndex = 0;
    rate.dispatchEvent(new Event("change"));
    const clean = box.dataset.scene;
    key("ArrowUp");
    check(box.dataset.scene !== clean && /fp_0.30/.test(box.dataset.scene), "up takes the next rate");
    check(document.querySelector("#view-methods td").textContent !== "", "the answers are listed");

    const condition = document.getElementById("view-condition");
    check([...condition.options].map((option) => option.value).join() === "paper,car", "conditions can be chosen");
    condition.value = "car";
    condition.dispatchEvent(new Event("change"));
    check(/fp_0.30.*\\/car$/.test(box.dataset.scene) && box.dataset.scene.startsWith("circle/"),
          "another condition, the same track and rate");
    check(document.querySelector("#view-methods td").textContent !== "", "usable or not is listed");
    check(document.querySelector("#view-scene").getAttribute("aria-label").includes("false positives"), "it is said");
    condition.value = "paper";
    condition.dispatchEvent(new Event("change"));

    document.getElementById("view-speed").value = "25";
    key(" ");
    await wait(400);
    check(pose() > 0, "space plays");
    await wait(60 * (last() + 5));
    check(toggles.length === 3 && toggles.every((toggle) => toggle.checked), "with all three methods");
    check(pose() === last() && document.getElementById("view-play").textContent === "▶", "the lap ends");

    const map = document.getElementById("view-map");
    const place = map.getBoundingClientRect();
    map.dispatchEvent(new MouseEvent("click", { clientX: place.x + 5, clientY: place.y + place.height / 2 }));
    scene.dispatchEvent(new PointerEvent("pointermove", { clientX: 5, clientY: 5 }));

    const link = document.querySelector("[data-open]");
    link.click();
    check(box.dataset.scene === link.dataset.open, "a scene of the gallery opens");

    const table = document.querySelector("#quality table");
    const column = [...table.tHead.rows[0].cells].findIndex((cell) => cell.textContent === "success %");
    const values = () => [...table.tBodies[0].rows].map((row) => Number(row.cells[column].dataset.value));
    table.tHead.rows[0].cells[column].click();
    check(String(values()) === String(values().sort((a, b) => b - a)), "the first click sorts downward");
    table.tHead.rows[0].cells[column].click();
    check(String(values()) === String(values().sort((a, b) => a - b)), "the second one upward");

    const filter = document.querySelector('[data-filter="method"]');
    filter.value = "clc";
    filter.dispatchEvent(new Event("change"));
    const visible = [...table.tBodies[0].rows].filter((row) => !row.hidden);
    check(visible.length === 4 && visible.every((row) => row.dataset.method === "clc"), "the filter leaves CLC");
    const blocks = [...document.querySelectorAll("#by-rate tbody")];
    check(blocks.length === 4 && blocks.every((block) => [...block.rows].filter((row) => !row.hidden).length === 2),
          "in each block of the table by rate too");
    check([...document.querySelectorAll("#headline tbody tr")].every((row) => !row.hidden), "the first table stays whole");
    const curves = [...document.querySelectorAll("#success-by-rate g[data-curve]")];
    check(curves.length >= 3 && curves.every((one) => (one.style.display === "") === (one.dataset.curve === "clc")),
          "of the charts the curve of CLC stays");
    const ofSets = [...document.querySelectorAll("#growth g[data-curve]")];
    filter.value = "rld-cbc n=12";
    filter.dispatchEvent(new Event("change"));
    check(ofSets.filter((one) => one.style.display === "").every((one) => one.dataset.curve === "rld-cbc"),
          "a method is found whatever its cone set");
    filter.value = "clc";
    filter.dispatchEvent(new Event("change"));
    const chosen = document.querySelector('[data-filter="condition"]');
    chosen.value = "car";
    chosen.dispatchEvent(new Event("change"));
    check([...document.querySelectorAll("#by-rate tr.block")].filter((row) => !row.hidden).length === 2,
          "blocks of other conditions go");
    check(document.getElementById("usable-by-rate-paper").hidden && !document.getElementById("usable-by-rate-car").hidden,
          "so do figures of other conditions");
    check([...document.querySelectorAll("details.worst")].filter((block) => !block.hidden).length === 1,
          "and pictures of other conditions and methods");

    const ground = () => getComputedStyle(document.body).backgroundColor;
    const light = ground(), drawn = pixels();
    document.getElementById("theme").click();
    check(ground() !== light && pixels() !== drawn, "the theme changes, the drawing with it");
    check(document.documentElement.scrollWidth <= innerWidth, "nothing is wider than the screen");
    dispatchEvent(new Event("beforeprint"));
    check(document.documentElement.dataset.theme === "light", "it is printed in the light theme");
    dispatchEvent(new Event("afterprint"));
    check(document.documentElement.dataset.theme !== "light", "and shown in the dark one again");
    const loaded = performance.getEntriesByType("resource").map((one) => one.name).filter((name) => !name.startsWith("data:"));
    check(loaded.length === 0, "nothing is loaded from elsewhere: " + loaded);
  } catch (error) {
    problems.push(String(error.stack || error));
  }
  const result = document.createElement("pre");
  result.id = "outcome";
  result.textContent = JSON.stringify(problems);
  document.body.append(result);
});
</script>"""


def with_uncertain_answers(text):
    """The page, but in the first scenes of the circle one method knows one boundary alone, and one trusts 10 m, alone."""
    data = re.search(r'(<script[^>]*id="scene-data"[^>]*>)(.*?)(</script>)', text, flags=re.S)
    scenes = json.loads(data[2])
    for lap in scenes["laps"]:
        if lap["track"] != "circle":
            continue
        answers = scenes["frames"][lap["scenes"][0]]["a"]
        for answer in answers:
            answer[10] = None
        alone, trusted = answers[:2]
        alone[1] = []
        trusted[10] = 10.0
    return text[:data.start(2)] + json.dumps(scenes) + text[data.end(2):]


def main():
    if len(sys.argv) < 3 or not os.access(sys.argv[2], os.X_OK):
        print("skipped: there is no Chromium (Debian: apt-get install chromium)")
        return 77
    page, chromium = sys.argv[1:3]
    with open(page, encoding="utf-8") as stream:
        text = with_uncertain_answers(stream.read())
    with tempfile.TemporaryDirectory() as folder, Chromium(chromium) as browser:
        copy = os.path.join(folder, "page.html")
        with open(copy, "w", encoding="utf-8") as stream:
            stream.write(text.replace("<head>", "<head>" + WATCH, 1).replace("</body>", USE + "</body>", 1))
        problems = []
        for width in (1280, 500):
            browser.size(width, 900)
            browser.open("file://" + copy)
            outcome = browser.wait_for("document.getElementById('outcome')?.textContent")
            browser.value("localStorage.clear()")  # the theme that was chosen
            problems += [f"{width} px wide: {problem}" for problem in json.loads(outcome) + browser.problems]
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
