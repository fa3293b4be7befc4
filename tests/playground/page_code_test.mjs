// page_code_test.mjs: what of the page needs no browser: files, links, what the car sees.
import assert from "node:assert/strict";
import { test } from "node:test";
import { readdirSync, readFileSync } from "node:fs";

const page = new URL("../../playground/page/", import.meta.url);
const { readBytes, readText } = await import(new URL("files.mjs", page));
const { readLink, writeLink } = await import(new URL("link.mjs", page));
const { DEFAULT_SIGHT, drawn, FALSE_IDS, inView, look, worldOfCones } = await import(new URL("world.mjs", page));
const { drive, frameOf, startRun } = await import(new URL("drive.mjs", page));

const refuses = (text, message) => assert.throws(() => readText(text, "f"), (error) => {
  assert.equal(error.message, message);
  return true;
});
const row = Array.from({ length: 40 }, (_, i) => ({ id: i + 1, x: 1 + 2 * Math.floor(i / 2), y: i % 2 ? 1.8 : -1.8, color: "unknown" }));
const world = () => worldOfCones("row", row.map((cone) => ({ ...cone })), { x: 0, y: 0, yaw: 0 });

const tests = {
  "scenes and lanes"() {
    const scene = '{"id": "a", "pose": {"x": 1, "y": 2, "yaw": 3}, "cones": [{"id": 7, "x": 4, "y": 5, "color": "blue"}]}';
    const lane = '{"scene": "a", "method": "m", "left": [7], "right": []}';
    const read = readText(`${scene}\n\n${lane}\n`, "f");
    assert.deepEqual(read.scenes[0].cones, [{ id: 7, x: 4, y: 5, color: "blue" }]);
    assert.equal(read.lanes.length, 1);
    assert.equal(readText(lane, "f").kind, "lanes");
    refuses(`${scene}\n{"id": 1}`, "f:2: is neither a scene (pose, cones) nor a lane (scene, left, right)");
    refuses('{"pose": {"x": 1, "y": 2}, "cones": []}', "f:1: pose.yaw: must be a finite number");
    refuses(scene.replace('"x": 4', '"x": 1e8'), "f:1: cones[0].x: is beyond 10^7 m");
    refuses('{"pose": {"x": 1, "y": 2, "yaw": 3}, "cones": [{"id": 7, "x": 4, "y": 5}, {"id": 7, "x": 4, "y": 5}]}', "f:1: cones[1].id: is there twice");
    refuses('{"scene": "a", "left": ["7"], "right": []}', "f:1: left: must be a list of cone ids");
    assert.throws(() => readText('{"pose": ', "f"), /^FileError: f:1: is not JSON: |^Error: f:1: is not JSON: /);
    refuses("hello", "f: is not a scenes or lanes file, an EUFS or PacSim course or an ft-fsd run");
  },
  "a course of EUFS"() {
    const read = readText("tag,x,y,direction,x_variance\nblue,1,2,0,0.1\r\nbig_orange,3,4,0,0\ncar_start,0.5,0,1.5,0\n", "f");
    assert.deepEqual(read.cones.map(({ x, color }) => [x, color]), [[1, "blue"], [3, "orange"]]);
    assert.deepEqual(read.start, { x: 0.5, y: 0, yaw: 1.5 });
    const facing = readText("tag,x,y,direction\nblue,0,2,0\nyellow,0,-2,0\nyellow,9,-2,0\n", "f");
    assert.ok(Math.abs(facing.start.yaw) < 1e-12 && facing.start.x < 0 && facing.start.y === 0);
    refuses("tag,x,direction\nblue,1,2", "f:1: y: column missing");
    refuses("tag,x,y,direction\nblue,1,two,0", "f:2: y: must be a finite number");
    refuses("tag,x,y,direction\nblue,1", "f:2: y: missing");
  },
  "a course of PacSim"() {
    const text = "track:\n  version: 1.0\n  lanesFirstWithLastConnected: false\n  start:\n    position: [1.0, 2.0, 0.0]\n    orientation: [0.0, 0.0, 0.5]\n" +
      "  left:\n  - position: [0.5, 2.0, 0.0]\n    class: blue\n  right:\n  - position: [0.5, -2.0, 0.0]\n    class: yellow\n  time_keeping:\n  - position: [9, 9, 0]\n    class: timekeeping\n  unknown: []\n";
    const read = readText(text, "f");
    assert.deepEqual(read.cones.map(({ y, color, side }) => [y, color, side]), [[2, "blue", "left"], [-2, "yellow", "right"]]);
    assert.deepEqual(read.start, { x: 1, y: 2, yaw: 0.5 });
    assert.equal(read.closed, false);
    refuses(text.replace("[0.5, -2.0, 0.0]", "[0.5]"), "f:11: right.position: is not [x, y, z]");
    refuses("track:\n  left: []\n", "f: track: holds no cone");
  },
  "a run of ft-fsd: cones keep their ids"() {
    const frame = (x) => ({ car_position: [x, 0], car_direction: [0, 2], slam_cones: [[[5, 5]], [[x * 0.1 + 9, 0]], [], [], []] });
    const read = readText(JSON.stringify([frame(0), frame(1)]), "f");
    assert.ok(Math.abs(read.scenes[0].pose.yaw - Math.PI / 2) < 1e-12);
    assert.deepEqual(read.scenes[0].cones.map(({ id }) => id), read.scenes[1].cones.map(({ id }) => id));
    refuses("[]", "f: holds no frame");
    refuses(JSON.stringify([{ ...frame(0), slam_cones: [] }]), "f: [0].slam_cones: must hold five lists");
    refuses("[{}]", "f: [0].car_position: must be [x, y]");
  },
  async "packed files"() {
    const text = '{"id": "a", "pose": {"x": 1, "y": 2, "yaw": 3}, "cones": []}';
    const packed = await new Response(new Blob([text]).stream().pipeThrough(new CompressionStream("gzip"))).arrayBuffer();
    assert.equal((await readBytes(new Uint8Array(packed), "f.gz")).scenes[0].id, "a");
  },
  async "a link holds the scene"() {
    const given = { world: world(), car: { x: 1.234, y: -5, yaw: 0.5 }, sight: { ...DEFAULT_SIGHT, rate: 0.2 }, methods: ["front"] };
    given.world.gone.add(FALSE_IDS + 5);
    given.world.cones[3].is_false = true;
    const link = await writeLink(given);
    assert.match(link, /^1\.[A-Za-z0-9_-]+$/);
    assert.ok(link.length < 1000);
    const read = await readLink(link);
    assert.deepEqual(read.world.cones, given.world.cones);
    assert.deepEqual([...read.world.gone], [FALSE_IDS + 5]);
    assert.deepEqual(read.sight, given.sight);
    assert.equal(read.car.x, 1.23);
    await assert.rejects(readLink(link.slice(0, 40)), /broken/);
    await assert.rejects(readLink("0.abc"), /another version/);
  },
  "what the car sees"() {
    const car = { x: 0, y: 0, yaw: 0 }, sight = { ...DEFAULT_SIGHT, rate: 0.4, missed: 0.2 };
    const once = look(world(), car, sight);
    assert.deepEqual(look(world(), car, sight), once);
    const wrong = once.cones.filter((cone) => cone.is_false);
    assert.ok(Math.abs(wrong.length / once.cones.length - 0.4) < 0.03);
    assert.ok(once.missed.length > 0 && once.cones.every((cone) => cone.id >= FALSE_IDS || !once.missed.some(({ id }) => id === cone.id)));
    assert.ok(wrong.every(({ x, y }) => inView(car, sight.range_m, x, y)));
    assert.equal(new Set(once.cones.map(({ id }) => id)).size, once.cones.length);
    // False cones keep id and place while the car goes on; more of them leave those that were there.
    const more = look(world(), car, { ...sight, rate: 0.5 }).cones;
    for (const { id, x } of wrong) assert.equal(more.find((cone) => cone.id === id)?.x, x);
    const exact = look(world(), { x: 0, y: 0, yaw: Math.PI }, { ...sight, exact: true });
    assert.equal(exact.cones.length, 40);
    const none = look(world(), car, { ...DEFAULT_SIGHT, rate: 0, missed: 0, noise_m: 0 });
    assert.ok(none.cones.every(({ id, x }) => row[id - 1].x === x));
    const off = look(world(), car, { ...DEFAULT_SIGHT, rate: 0, missed: 0, noise_m: 0.2 }).cones.map(({ id, x }) => x - row[id - 1].x);
    const deviation = Math.sqrt(off.reduce((sum, one) => sum + one * one, 0) / off.length);
    assert.ok(deviation > 0.1 && deviation < 0.3, String(deviation));
    assert.ok(drawn(1, 2) >= 0 && drawn(1, 2) < 1 && drawn(1, 2) !== drawn(2, 1));
  },
  "a car drives along a path, and stops at its end"() {
    const ground = world(), run = startRun(ground, { x: 0, y: 0.3, yaw: 0 });
    const frame = frameOf(run, ground, DEFAULT_SIGHT);
    assert.ok(frame.time_s === 0 && frame.cones.length > 10);
    for (let i = 0; i < 200 && run.state === "driving"; i++) {
      const points = Array.from({ length: 61 }, (_, k) => ({ s_m: k / 2, x: k / 2, y: 0, curvature_1pm: 0 }));
      const ahead = points.filter(({ x }) => x >= run.car.x);
      const lane = { points: ahead.map((point) => ({ ...point, s_m: point.s_m - ahead[0].s_m })) };
      drive(run, { state: "following", lane, safe_m: 30, stop: true, latency_ms: 1 }, ground);
    }
    assert.equal(run.state, "stopped");
    assert.ok(run.car.x > 25 && run.car.x <= 30 && Math.abs(run.car.y) < 0.1, JSON.stringify(run.car));
    assert.equal(run.hit.size, 0);
  },
};

tests["what a file of the page imports is exported by the file that it names"] = () => {
  const files = readdirSync(page).filter((name) => name.endsWith(".mjs"));
  const textOf = Object.fromEntries(files.map((name) => [name, readFileSync(new URL(name, page), "utf8")]));
  const exported = (text) => [...text.matchAll(/^export (?:async )?(?:function|class|const|let) (.+)$/gm)].join("\n");
  for (const [name, text] of Object.entries(textOf)) {
    for (const [, names, from] of text.matchAll(/^import \{([^}]*)\} from "\.\/([^"]+)";$/gm)) {
      if (!(from in textOf)) continue; // the module, for the worker
      for (const one of names.split(",").map((word) => word.trim()).filter(Boolean))
        assert.match(exported(textOf[from]), new RegExp(`(?<![\\w$])${one.replace("$", "\\$")}(?![\\w$])`), `${name}: ${one} of ${from}`);
    }
    assert.ok(text.split("\n").length < 350, `${name} is long: split it by subject`);
  }
  const importsOf = (name) => [...(textOf[name] ?? "").matchAll(/^import .* from "\.\/([^"]+)";$/gm)].map(([, from]) => from);
  const visit = (name, path) => {
    assert.ok(!path.includes(name), `files import each other in a circle: ${[...path, name].join(", ")}`);
    for (const from of importsOf(name)) visit(from, [...path, name]);
  };
  for (const name of files) visit(name, []);
};

for (const [name, run] of Object.entries(tests)) test(name, run);
