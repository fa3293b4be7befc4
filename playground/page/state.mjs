// What is shown, and what every subject of the page uses.
import { DEFAULT_SIGHT } from "./world.mjs";

export const $ = (id) => document.getElementById(id);
export const canvas = $("ground"), stage = $("stage"), ctx = canvas.getContext("2d", { alpha: false });

export const METHODS = [
  { name: "front", color: "m0", width: 7, opacity: 0.55, dash: [], cap: "round", about: "learned search" },
  { name: "clc", color: "m1", width: 3.5, dash: [11, 7], cap: "butt", about: "graph search" },
  { name: "rld-pair", color: "m2", width: 2.5, dash: [2, 5], cap: "round", about: "exact, proven" },
];

export class View {
  constructor() { Object.assign(this, { x: 0, y: 0, scale: 10, width: 1, height: 1 }); }
  at([x, y]) { return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale]; }
  metres(px, py) { return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale]; }
  /** Shows places; the room at the top is for the tools. */
  fit(places, margin = 24, top = 44) {
    const [[x0, x1], [y0, y1]] = ["x", "y"].map((axis) => places.map((place) => place[axis])).map((all) => [Math.min(...all), Math.max(...all)]);
    const wide = Math.max(x1 - x0, 6), high = Math.max(y1 - y0, 6);
    this.scale = Math.min((this.width - 2 * margin) / wide, (this.height - 2 * margin - top) / high, 60);
    this.x = (x0 + x1) / 2;
    this.y = (y0 + y1) / 2 + top / 2 / this.scale;
  }
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.metres(px, py);
    this.scale = Math.min(Math.max(this.scale * factor, 0.8), 120);
    const [nx, ny] = this.metres(px, py);
    this.x += x - nx;
    this.y += y - ny;
  }
}

export const view = new View();
export const state = {
  world: null, car: { x: 0, y: 0, yaw: 0 }, sight: { ...DEFAULT_SIGHT }, methods: { front: true, clc: false, "rld-pair": false },
  limit_ms: 50, seen: [], missed: [], found: {}, marks_false: true, selected: null, hovered: null, edge: null, run: null,
  file: null, file_lanes: [], original: null,
  playing: false, following: true,  // the car is kept in the picture, unless the user looks elsewhere
  dragging: null,  // {kind, id, ...} of the one pointer that moves something
};

/** Two workers with the module: `first` finds lanes and plans; `second` tests itself and explains, which may take longer. */
export const clients = { first: null, second: null };

// What happens is told to whoever wants to know: a file of the page imports only those before it in the order state, draw, detect_loop,
// panels, main.
const listeners = {};
export const on = (event, action) => { (listeners[event] ??= []).push(action); };
export const tell = (event, ...what) => listeners[event]?.forEach((action) => action(...what));

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
