// Mouse and touch.
import { coneSize, handleOf } from "./draw.mjs";
import { canvas, state, view } from "./state.mjs";
import { changed } from "./detect_loop.mjs";
import { explainSoon } from "./explanation.mjs";
import { saveSoon } from "./saved_link.mjs";
import { addCone, deleteCone, ownCone, remember, select } from "./changes.mjs";

const pointers = new Map();
let pinch = null;
let lastTap = { at: 0, x: 0, y: 0 };
const mode = () => document.querySelector('input[name="mode"]:checked').value;

function placeOf(event) {
  const box = canvas.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

function coneAt(px, py, reach) {
  const known = new Set(state.seen.map((one) => one.id));
  let best = null, distance = reach;
  for (const cone of [...state.world.cones.filter((one) => !known.has(one.id)), ...state.seen]) {
    const [x, y] = view.at([cone.x, cone.y]), far = Math.hypot(x - px, y - py);
    if (far <= distance) [best, distance] = [cone.id, far];
  }
  return best;
}

/** The edge of the exact solver's lane that is nearest, as two ids. */
function edgeAt(px, py, reach) {
  const answer = state.found["rld-pair"]?.answer;
  if (!state.methods["rld-pair"] || answer?.status !== "found") return null;
  const place = new Map(state.seen.map((cone) => [cone.id, view.at([cone.x, cone.y])]));
  let best = null, distance = reach;
  for (const side of [answer.left, answer.right]) {
    for (let i = 0; i + 1 < side.length; i++) {
      const a = place.get(side[i]), b = place.get(side[i + 1]);
      if (!a || !b) continue;
      const dx = b[0] - a[0], dy = b[1] - a[1];
      const share = Math.min(Math.max(((px - a[0]) * dx + (py - a[1]) * dy) / (dx * dx + dy * dy || 1), 0), 1);
      const far = Math.hypot(a[0] + share * dx - px, a[1] + share * dy - py);
      if (far < distance) [best, distance] = [[side[i], side[i + 1]], far];
    }
  }
  return best;
}

canvas.addEventListener("pointerdown", (event) => {
  if (event.button > 0) return;
  canvas.setPointerCapture?.(event.pointerId);
  const [px, py] = placeOf(event);
  pointers.set(event.pointerId, [px, py]);
  if (pointers.size === 2) {
    state.dragging = null;
    const [a, b] = [...pointers.values()];
    pinch = { distance: Math.hypot(a[0] - b[0], a[1] - b[1]), x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2 };
    return;
  }
  if (pointers.size > 2) return;
  const reach = event.pointerType === "touch" ? 24 : 12 + coneSize() / 2;
  const id = coneAt(px, py, reach);
  const near = ([x, y], far) => Math.hypot(x - px, y - py) <= far;
  state.dragging = { kind: "pan", from: [px, py], last: [px, py], id, isMoved: false };
  if (!state.run && near(handleOf(state.car), event.pointerType === "touch" ? 24 : 12)) state.dragging.kind = "turn";
  else if (id !== null) state.dragging.kind = "cone";
  else if (!state.run && near(view.at([state.car.x, state.car.y]), Math.max(1.3 * view.scale, 18))) state.dragging.kind = "car";
  changed("picture");
});

canvas.addEventListener("pointermove", (event) => {
  const [px, py] = placeOf(event);
  if (!pointers.has(event.pointerId)) {
    if (event.pointerType !== "touch") hover(px, py);
    return;
  }
  pointers.set(event.pointerId, [px, py]);
  if (pinch && pointers.size === 2) {
    const [a, b] = [...pointers.values()];
    const now = { distance: Math.hypot(a[0] - b[0], a[1] - b[1]), x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2 };
    view.x -= (now.x - pinch.x) / view.scale;
    view.y += (now.y - pinch.y) / view.scale;
    view.zoom(now.distance / Math.max(pinch.distance, 1), now.x, now.y);
    pinch = now;
    state.following = false;
    changed("picture");
    return;
  }
  if (!state.dragging) return;
  if (!state.dragging.isMoved) {
    if (Math.hypot(px - state.dragging.from[0], py - state.dragging.from[1]) < 4) return;
    state.dragging.isMoved = true;
    if (state.dragging.kind !== "pan") remember();
    if (state.dragging.kind === "cone") state.dragging.cone = ownCone(state.dragging.id);
    if (state.dragging.cone) select(state.dragging.cone.id);
  }
  const dx = (px - state.dragging.last[0]) / view.scale, dy = -(py - state.dragging.last[1]) / view.scale;
  state.dragging.last = [px, py];
  if (state.dragging.kind === "pan") {
    view.x -= dx;
    view.y -= dy;
    state.following = false;
    changed("picture");
  } else if (state.dragging.kind === "cone" && state.dragging.cone) {
    state.dragging.cone.x += dx;
    state.dragging.cone.y += dy;
    changed();
  } else if (state.dragging.kind === "car") {
    state.car.x += dx;
    state.car.y += dy;
    changed();
  } else if (state.dragging.kind === "turn") {
    const [x, y] = view.metres(px, py);
    state.car.yaw = Math.atan2(y - state.car.y, x - state.car.x);
    changed();
  }
});

function release(event) {
  const [px, py] = placeOf(event);
  pointers.delete(event.pointerId);
  if (pointers.size < 2) pinch = null;
  const drag = state.dragging;
  state.dragging = null;
  if (!drag) return;
  if (drag.isMoved) {
    if (drag.kind !== "pan") saveSoon();
    changed(drag.kind === "pan" ? "picture" : "scene");
    return;
  }
  if (event.type === "pointercancel") return;
  const [x, y] = view.metres(px, py), now = performance.now();
  const isDouble = now - lastTap.at < 350 && Math.hypot(px - lastTap.x, py - lastTap.y) < 20;
  lastTap = { at: isDouble ? 0 : now, x: px, y: py };
  if (drag.id !== null) {
    if (mode() === "delete") deleteCone(drag.id);
    else select(drag.id === state.selected ? null : drag.id);
  } else if (mode() === "add" || (mode() === "move" && isDouble)) addCone(x, y);
  else {
    select(null);
    const edge = edgeAt(px, py, 14);
    if (edge) {
      state.edge = edge;
      changed("picture");
      explainSoon();
    }
  }
}
canvas.addEventListener("pointerup", release);
canvas.addEventListener("pointercancel", release);
canvas.addEventListener("pointerleave", () => { if (state.hovered !== null) hover(-1e4, -1e4); });
canvas.addEventListener("contextmenu", (event) => {
  if (event.pointerType === "touch") { // a finger that rests
    event.preventDefault();
    return;
  }
  const id = coneAt(...placeOf(event), 14);
  if (id === null || mode() !== "move") return;
  event.preventDefault();
  deleteCone(id);
});
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  view.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.04 : 0.0016)), ...placeOf(event));
  changed("picture");
}, { passive: false });

function hover(px, py) {
  const id = coneAt(px, py, 12 + coneSize() / 2);
  let edge = null;
  if (id !== null && state.selected !== null && id !== state.selected) edge = [state.selected, id];
  else if (id === null) edge = edgeAt(px, py, 8);
  canvas.style.cursor = id !== null ? (mode() === "delete" ? "not-allowed" : "move") : mode() === "add" ? "copy" : "grab";
  if (id === state.hovered && String(edge) === String(state.edge)) return;
  state.hovered = id;
  state.edge = edge;
  changed("picture");
  explainSoon();
}
