// Keys.
import { coneName } from "./world.mjs";
import { canvas, METHODS, say, state, view } from "./state.mjs";
import { changed } from "./detect_loop.mjs";
import { saveSoon } from "./saved_link.mjs";
import { fitAll, fitView } from "./picture.mjs";
import { addCone, deleteCone, ownCone, remember, select, undo } from "./changes.mjs";
import { turn } from "./method_cards.mjs";
import { togglePlay } from "./playback.mjs";

function selectNext(step) {
  const { car } = state;
  const cones = [...state.seen].sort((a, b) => Math.hypot(a.x - car.x, a.y - car.y) - Math.hypot(b.x - car.x, b.y - car.y));
  if (!cones.length) return;
  const at = cones.findIndex((cone) => cone.id === state.selected);
  select(cones[at < 0 ? (step > 0 ? 0 : cones.length - 1) : (at + step + cones.length) % cones.length].id);
}

let lastNudge = 0;
function nudge(dx, dy, turnBy = 0) {
  if (performance.now() - lastNudge > 800) remember();
  lastNudge = performance.now();
  if (turnBy) state.car.yaw += turnBy;
  else if (state.selected !== null) {
    const cone = ownCone(state.selected);
    if (!cone) return;
    cone.x += dx;
    cone.y += dy;
    if (cone.id !== state.selected) state.selected = cone.id;
    say(`cone ${coneName(cone.id)} at ${cone.x.toFixed(2)}, ${cone.y.toFixed(2)} m`);
  } else if (!state.run) {
    state.car.x += dx;
    state.car.y += dy;
  }
  changed();
  saveSoon();
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

addEventListener("keydown", (event) => {
  const isTyping = event.target.closest?.("input:not([type=checkbox]):not([type=radio]), select, textarea");
  if (event.altKey || event.metaKey || (event.ctrlKey && event.key !== "z")) return;
  if (event.ctrlKey) {
    undo();
    event.preventDefault();
    return;
  }
  if (isTyping) return;
  const isCanvas = event.target === canvas || event.target === document.body;
  const step = event.shiftKey ? 0.05 : 0.25;
  if (event.key in ARROWS && isCanvas) nudge(ARROWS[event.key][0] * step, ARROWS[event.key][1] * step);
  else if (event.key === " " && isCanvas) togglePlay();
  else if (event.key === "[" || event.key === "]") selectNext(event.key === "]" ? 1 : -1);
  else if (event.key === "q" || event.key === "e") nudge(0, 0, (event.key === "q" ? 1 : -1) * (event.shiftKey ? 0.01 : 0.05));
  else if (event.key === "a") {
    const from = state.seen.find((cone) => cone.id === state.selected) ?? { x: state.car.x + 6 * Math.cos(state.car.yaw), y: state.car.y + 6 * Math.sin(state.car.yaw) };
    addCone(from.x + 0.5, from.y + 0.5);
  } else if ((event.key === "Delete" || event.key === "Backspace") && state.selected !== null) deleteCone(state.selected);
  else if (event.key === "Escape") select(null);
  else if (event.key === "+" || event.key === "-") { view.zoom(event.key === "+" ? 1.25 : 0.8); changed("picture"); }
  else if (event.key === "0") fitView();
  else if (event.key === "9") fitAll();
  else if (["1", "2", "3"].includes(event.key)) turn(METHODS[event.key - 1].name, !state.methods[METHODS[event.key - 1].name]);
  else return;
  event.preventDefault();
});
