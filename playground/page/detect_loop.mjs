// Looks, asks the methods and draws, once a frame at most.
import { draw } from "./draw.mjs";
import { look, sceneOf } from "./world.mjs";
import { clients, METHODS, showError, state, tell } from "./state.mjs";

export let version = 0;               // of the scene
export const doneVersion = {};        // by method: of the scene that it answered last
export const times = {};              // by method: latest latencies
let isLookDue = true, isFrameAsked = false, isDetecting = false;

export function changed(what = "scene") {
  if (what === "scene") isLookDue = true;
  if (isFrameAsked) return;
  isFrameAsked = true;
  requestAnimationFrame(frame);
}

function frame() {
  isFrameAsked = false;
  if (!state.world) return;
  if (isLookDue) {
    isLookDue = false;
    if (state.run) {
      state.seen = state.run.seen?.cones ?? [];
      state.missed = state.run.seen?.missed ?? [];
    } else {
      const { cones, missed } = look(state.world, state.car, state.sight);
      Object.assign(state, { seen: cones, missed });
      version += 1;
      detectLoop();
    }
    tell("looked");
  }
  draw();
  if (state.dragging) changed("picture");
}

/** Asks the methods that are on, the one whose answer is oldest first. While a cone is dragged all of them follow. */
export async function detectLoop() {
  if (isDetecting) return;
  isDetecting = true;
  while (!state.run) {
    const due = METHODS.filter(({ name }) => state.methods[name] && (doneVersion[name] ?? -1) < version)
      .sort((a, b) => (doneVersion[a.name] ?? -1) - (doneVersion[b.name] ?? -1));
    if (due.length === 0) break;
    const { name } = due[0];
    const asked = version;
    try {
      const scene = sceneOf(state.car, state.seen);
      const found = await clients.first.ask("detect", { scene, method: name, time_limit_ms: state.limit_ms });
      state.found[name] = found;
      (times[name] ??= []).push(found.answer.latency_ms);
      if (times[name].length > 25) times[name].shift();
    } catch (error) {
      state.found[name] = { answer: { status: "error", message: error.message, left: [], right: [] }, line: null };
      showError(error.message);
    }
    doneVersion[name] = asked;
    tell("answered", name);
    changed("picture");
  }
  isDetecting = false;
  document.body.dataset.version = String(version);
  settled.splice(0).forEach((one) => one());
  tell("settled");
}

const settled = [];
const isSettled = () => !isLookDue && METHODS.every(({ name }) => !state.methods[name] || doneVersion[name] === version);
/** Until every method has answered for what is shown. */
export const whenSettled = () => (isSettled() ? Promise.resolve() : new Promise((done) => settled.push(done)));
