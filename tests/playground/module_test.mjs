// module_test.mjs MODULE_DIR STORED.json: the module in Node. Its lanes are those of the native program; what is not valid is
// refused by name; an error inside ends an instance, and the next call has another. Exit code 77 where it was not built.
import assert from "node:assert/strict";
import { test } from "node:test";
import { existsSync, readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [folder, storedFile] = process.argv.slice(2);
if (!existsSync(`${folder}/conelane.wasm`)) {
  console.log("skipped: the module was not built, since packages of [playground] in .ci/packages.txt are missing");
  process.exit(77);
}
const { load, ConelaneError } = await import(pathToFileURL(`${folder}/conelane.mjs`));
const { selfTest } = await import(new URL("../../playground/page/self_test.mjs", import.meta.url));
const { explainCone, explainEdge } = await import(new URL("../../playground/page/explain.mjs", import.meta.url));
const conelane = await load();
const stored = JSON.parse(readFileSync(storedFile));

/** Two straight boundaries, 3.6 m apart; left ids are odd. */
const straight = (count = 8) => ({
  pose: { x: 0, y: 0, yaw: 0 },
  cones: Array.from({ length: 2 * count }, (_, i) => ({ id: i, x: 1 + 4 * Math.floor(i / 2), y: i % 2 ? 1.8 : -1.8 })),
});
const refuses = (call, message) => assert.throws(call, (error) => {
  assert.ok(error instanceof ConelaneError, String(error));
  assert.match(error.message, message);
  return true;
});

const tests = {
  "the lanes are those of the native program"() {
    const { failed, lanes, scenes } = selfTest(conelane, stored);
    assert.deepEqual(failed, []);
    assert.equal(scenes, 10);
    assert.equal(lanes, 30);
    assert.ok(stored.every(({ answers }) => answers.some(({ status }) => status === "found")));
    const broken = structuredClone(stored);
    broken[3].answers[0].left.pop();
    assert.deepEqual(selfTest(conelane, broken).failed, [`${broken[3].scene.id}, front: another lane`]);
  },
  "detect answers as documented"() {
    const answer = conelane.detect(straight());
    assert.equal(answer.method, "front");
    assert.equal(answer.status, "found");
    assert.deepEqual(answer.left, [1, 3, 5, 7, 9, 11, 13, 15]);
    assert.deepEqual(answer.right, [0, 2, 4, 6, 8, 10, 12, 14]);
    assert.ok(answer.confidence > 0.9 && answer.trusted_m > 10 && answer.latency_ms > 0);
    const few = conelane.detect(straight(), { method: "rld-pair", nearest: 8 });
    assert.equal(few.left.length + few.right.length, 8);
    assert.equal(conelane.detect({ pose: { x: 0, y: 0, yaw: 0 }, cones: [] }).status, "none");
    assert.deepEqual(conelane.detect({ ...straight(), cones: straight().cones.map(({ x, y }) => ({ x, y })) }).left, answer.left);
  },
  "parameters count"() {
    const given = conelane.detect(straight(), { method: "rld-pair" });
    const other = conelane.detect(straight(), { method: "rld-pair", parameters: { w_b: 2 } });
    assert.ok(Math.abs(other.objective - (given.objective - 14)) < 1e-9); // 14 edges, each with a benefit of one more
  },
  "the centre line is in the middle"() {
    const scene = straight(), answer = conelane.detect(scene);
    const line = conelane.centreLine(scene, answer, { step_m: 1 });
    assert.ok(line.points.length > 20 && line.points.every(({ y }) => Math.abs(y) < 1e-6));
    assert.ok(Math.abs(line.points[1].s_m - 1) < 1e-12 && Math.abs(line.points[5].width_left_m - 1.8) < 1e-6);
    assert.ok(line.trusted_m <= line.length_m);
  },
  "solve proves, check agrees, price adds up"() {
    const scene = straight(), solution = conelane.solve(scene, { time_limit_ms: Infinity });
    assert.equal(solution.status, "optimal");
    assert.equal(solution.edges.length, 14);
    assert.ok(solution.objective - solution.bound < 1e-8);
    const check = conelane.check(scene, solution.edges);
    assert.deepEqual(check.violations, []);
    assert.ok(Math.abs(check.objective - solution.objective) < 1e-9);
    const { edges, turns } = conelane.price(scene, solution.edges);
    const sum = [...edges, ...turns].reduce((total, { cost }) => total + cost, 0);
    assert.ok(Math.abs(sum - solution.objective) < 1e-9);
    assert.match(conelane.check(scene, [[0, 1]]).violations.join(), /\(3\)/);
    assert.equal(conelane.price(scene, [[0, 14]]).edges[0].high_cost, true);
  },
  "explanations are about the lane"() {
    const scene = straight();
    scene.cones.push({ id: 99, x: 7, y: 6 });
    const solution = conelane.solve(scene);
    const inside = explainCone(conelane, scene, solution, 3);
    assert.equal(inside.role, "left");
    assert.ok(inside.best.violations.length > 0 || inside.best.cost > 0); // the answer is an optimum
    const end = explainCone(conelane, scene, solution, 15);
    assert.ok(end.best.violations.length === 0 && end.best.cost > 0);
    const outside = explainCone(conelane, scene, solution, 99);
    assert.equal(outside.role, "none");
    assert.ok(outside.best.violations.length > 0 || outside.best.cost > 0);
    assert.match(outside.best.words, /^put /);
    const far = explainEdge(conelane, scene, solution, 0, 14);
    assert.ok(far.priced[0].high_cost && !far.is_chosen);
    assert.match(far.best.violations.join(), /\(27\)/);
  },
  "what is not valid is refused by name"() {
    const before = conelane.restarts;
    refuses(() => conelane.detect(), /^scene:/);
    refuses(() => conelane.detect({ cones: [] }), /^pose:/);
    refuses(() => conelane.detect({ ...straight(), pose: { x: NaN, y: 0, yaw: 0 } }), /^pose.x: must be a finite number/);
    refuses(() => conelane.detect({ ...straight(), cones: [{ id: 1, x: 0, y: 0 }, { id: 1, x: 1, y: 0 }] }), /^cones\[1\].id: 1 is there twice/);
    refuses(() => conelane.detect({ ...straight(), cones: [{ id: 1.5, x: 0, y: 0 }] }), /^cones\[0\].id/);
    refuses(() => conelane.detect({ ...straight(), cones: [{ id: 1, x: 0, y: 0, color: "red" }] }), /^cones\[0\].color/);
    refuses(() => conelane.detect(straight(), { method: "magic" }), /^method: there is no 'magic', only front, /);
    refuses(() => conelane.detect(straight(), { time_limit_ms: NaN }), /^time_limit_ms/);
    refuses(() => conelane.detect(straight(), { nearest: 0 }), /^nearest/);
    refuses(() => conelane.solve(straight(), { parameters: { d_e: -1 } }), /^d_e: must be in/);
    refuses(() => conelane.solve(straight(), { parameters: { dee: 1 } }), /^dee: is not a parameter/);
    refuses(() => conelane.check(straight(), [[1, 77]]), /^edges\[0\]: the scene has no cone 77/);
    refuses(() => conelane.course("nowhere"), /^course: there is no 'nowhere'/);
    refuses(() => conelane.planner({ mission: "flight" }), /^mission/);
    assert.equal(conelane.restarts, before);
  },
  "an error inside ends an instance, and the next call has another"() {
    const before = conelane.restarts;
    refuses(() => conelane.centreLine(straight(), { left: [1, 1], right: [0, 2], closed: false }), /left\[1\]/);
    refuses(() => conelane.centreLine(straight(), { left: [1, 3], right: [0, 2], closed: false }, { step_m: 0 }), /step_m/);
    refuses(() => conelane.detect(straight(), { method: "front", parameters: { d_e: 3 } }), /parameters/);
    assert.equal(conelane.detect(straight()).status, "found");
    assert.equal(conelane.restarts, before + 3);
  },
  "a planner follows, and remembers"() {
    const planner = conelane.planner({ laps: 1 });
    const scene = straight(), first = planner.update({ ...scene, time_s: 0 });
    assert.equal(first.state, "following");
    assert.ok(first.lane.points.length > 10 && first.safe_m > 5);
    const without = { time_s: 0.1, pose: { x: 0.5, y: 0, yaw: 0 }, cones: [] };
    const second = planner.update(without);
    assert.ok(["following", "bridging"].includes(second.state) && second.lane.points.length > 10);
    refuses(() => planner.update({ ...without, time_s: NaN }), /^time_s/);
    const unnamed = { ...straight(), time_s: 0.2, cones: straight().cones.map(({ x, y }) => ({ x, y })) };
    assert.equal(planner.update(unnamed).state, "following");
  },
  "courses are generated, the same again"() {
    const course = conelane.course("hairpins", 3);
    assert.equal(course.name, "hairpins@3");
    assert.ok(course.closed && course.left.length > 20 && course.line.length > 100);
    assert.deepEqual(conelane.course("hairpins", 3), course);
    assert.notDeepEqual(conelane.course("hairpins", 4).cones, course.cones);
  },
  "every method answers, within the limit"() {
    const { scene } = stored[5];
    for (const { name } of conelane.methods) {
      const answer = conelane.detect(scene, { method: name, time_limit_ms: 200 });
      assert.notEqual(answer.status, "error", `${name}: ${answer.message}`);
    }
    const stopped = conelane.detect(scene, { method: "rld-pair", time_limit_ms: 0 });
    assert.equal(stopped.stopped_by, "time");
  },
};

for (const [name, run] of Object.entries(tests)) test(name, run);
