// The worker: it holds the module, so that the page keeps its frames while a method searches.
import { load } from "../module/conelane.mjs";
import { explainCone, explainEdge } from "./explain.mjs";
import { selfTest } from "./self_test.mjs";

let conelane = null;
let planner = null;

/** The first calls of a module are slow: the browser is still compiling it. */
function warmUp() {
  const cones = Array.from({ length: 24 }, (_, i) => ({ id: i, x: 1 + 3 * (i >> 1), y: (i % 2 ? 1.8 : -1.8) + Math.sin(i >> 1) / 5 }));
  for (const method of ["front", "front", "front", "clc", "rld-pair"])
    detect({ scene: { pose: { x: 0, y: 0, yaw: 0 }, cones }, method, time_limit_ms: Infinity });
}

/** A lane, and the line to drive along it. A lane that cannot be driven has none. */
function detect({ scene, method, time_limit_ms }) {
  const answer = conelane.detect(scene, { method, time_limit_ms });
  const line = answer.status === "found" ? conelane.centreLine(scene, answer) : null;
  return { answer, line };
}

const tasks = {
  load: async ({ bytes }) => {
    conelane = await load(bytes);
    warmUp();
    const { version, methods, courses } = conelane;
    return { version, methods, courses };
  },
  detect,
  explain: ({ scene, cone, edge, time_limit_ms }) => {
    const solution = conelane.solve(scene, { time_limit_ms });
    if (solution.status === "error") throw new Error(solution.message);
    return edge ? explainEdge(conelane, scene, solution, ...edge) : explainCone(conelane, scene, solution, cone);
  },
  course: ({ name, seed }) => conelane.course(name, seed, 1),
  start: ({ laps }) => {
    planner = conelane.planner({ mission: "trackdrive", laps });
    return {};
  },
  plan: ({ frame, time_limit_ms }) => planner.update(frame, { time_limit_ms }),
  selfTest: ({ stored }) => selfTest(conelane, stored),
  centreLine: ({ scene, lane }) => conelane.centreLine(scene, lane),
};

addEventListener("message", async ({ data: { id, task, ...given } }) => {
  const restarts = conelane?.restarts ?? 0;
  try {
    if (!Object.hasOwn(tasks, task)) throw new Error(`there is no task '${task}'`);
    postMessage({ id, result: await tasks[task](given) });
  } catch (error) {
    postMessage({ id, error: error.message, is_restarted: (conelane?.restarts ?? 0) > restarts });
  }
});
