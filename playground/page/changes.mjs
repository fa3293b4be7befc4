// Changes of cones and car, undone.
import { coneName, FALSE_IDS, newId } from "./world.mjs";
import { $, METHODS, say, state } from "./state.mjs";
import { changed } from "./detect_loop.mjs";
import { explainSoon } from "./explanation.mjs";
import { saveSoon } from "./saved_link.mjs";

export const past = [];
export const snapshot = () => ({ cones: state.world.cones.map((cone) => ({ ...cone })), gone: [...state.world.gone], car: { ...state.car } });
export function remember() {
  past.push(snapshot());
  if (past.length > 200) past.shift();
  $("undo").disabled = false;
}
function restore({ cones, gone, car }) {
  state.world.cones = cones.map((cone) => ({ ...cone }));
  state.world.gone = new Set(gone);
  state.car = { ...car };
  changed();
  saveSoon();
}
export function undo() {
  if (past.length) restore(past.pop());
  $("undo").disabled = past.length === 0;
}
$("undo").addEventListener("click", undo);
$("reset").addEventListener("click", () => {
  remember();
  restore(state.original);
});

/** The cone of the world with this id. A false one becomes a cone of the world when it is touched. */
export function ownCone(id) {
  const own = state.world.cones.find((cone) => cone.id === id);
  if (own || id < FALSE_IDS) return own;
  const seen = state.seen.find((cone) => cone.id === id);
  if (!seen) return undefined;
  state.world.gone.add(id);
  const cone = { id: newId({ cones: state.world.cones }), x: seen.x, y: seen.y, color: "unknown", is_false: true };
  state.world.cones.push(cone);
  return cone;
}

export function addCone(x, y) {
  remember();
  const cone = { id: newId(state.world), x, y, color: "unknown" };
  state.world.cones.push(cone);
  select(cone.id);
  say(`cone ${coneName(cone.id)} added`);
  changed();
  saveSoon();
}

export function deleteCone(id) {
  remember();
  if (id >= FALSE_IDS) state.world.gone.add(id);
  else state.world.cones = state.world.cones.filter((cone) => cone.id !== id);
  if (state.selected === id) select(null);
  state.hovered = null;
  say(`cone ${coneName(id)} deleted`);
  changed();
  saveSoon();
}

export function select(id) {
  Object.assign(state, { selected: id, hovered: null, edge: null });
  const cone = state.seen.find((one) => one.id === id);
  if (id === null) say("");
  else if (cone) {
    const sides = METHODS.filter(({ name }) => state.methods[name] && state.found[name]).map(({ name }) => {
      const { left, right } = state.found[name].answer;
      return `${name}: ${left.includes(id) ? "left" : right.includes(id) ? "right" : "not in the lane"}`;
    });
    say(`cone ${coneName(id)} at ${cone.x.toFixed(1)}, ${cone.y.toFixed(1)} m. ${sides.join(", ")}`);
  }
  changed("picture");
  explainSoon();
}
