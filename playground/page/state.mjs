// What is shown, and what every subject of the page uses.
import { readColors, View } from "./draw.mjs";
import { DEFAULT_SIGHT } from "./world.mjs";

export const $ = (id) => document.getElementById(id);
export const canvas = $("ground"), stage = $("stage"), ctx = canvas.getContext("2d", { alpha: false });

export const view = new View();
export const state = {
  world: null, car: { x: 0, y: 0, yaw: 0 }, sight: { ...DEFAULT_SIGHT }, methods: { front: true, clc: false, "rld-pair": false },
  limit_ms: 50, seen: [], missed: [], found: {}, marks_false: true, selected: null, hovered: null, edge: null, run: null,
  file: null, file_lanes: [], original: null,
  playing: false, following: true,  // the car is kept in the picture, unless the user looks elsewhere
  dragging: null,  // {kind, id, ...} of the one pointer that moves something
  colors: readColors(document.documentElement),
};

/** Says something to a reader of the screen, too. */
export const say = (text) => { $("said").textContent = text; };

export const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];
export const ms = (value) => (value < 10 ? value.toFixed(2) : value.toFixed(value < 100 ? 1 : 0)) + " ms";
export const escape = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");

export function showError(message) {
  $("error").hidden = false;
  $("error").firstElementChild.textContent = message;
}
$("error").lastElementChild.addEventListener("click", () => { $("error").hidden = true; });
export const onRestart = (reason) => {
  document.body.dataset.restarts = String(Number(document.body.dataset.restarts ?? 0) + 1);
  showError(`The module reported: ${reason}. It was started again.`);
};

export async function attempt(action) {
  try {
    await action();
  } catch (error) {
    showError(error.message);
  }
}
