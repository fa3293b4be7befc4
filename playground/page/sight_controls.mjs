// What the car sees: sliders and counts.
import { $, canvas, on, state } from "./state.mjs";
import { changed } from "./detect_loop.mjs";
import { saveSoon } from "./saved_link.mjs";

export const LIMITS_MS = [20, 50, 100, 400, 2000];

const percent = (value) => `${Math.round(value * 100)} %`;
const SLIDERS = {
  rate: { key: "rate", say: percent }, noise: { key: "noise_m", say: (value) => `${value.toFixed(2)} m` },
  missed: { key: "missed", say: percent }, range: { key: "range_m", say: (value) => `${value.toFixed(0)} m` },
};
const sayOf = (id) => document.querySelector(`output[for="${id}"]`);

/** What a control does, and what follows from it. */
function control(id, act, isSight = true) {
  $(id).addEventListener(id === "redraw" ? "click" : "input", () => {
    act(Number($(id).value));
    if (isSight) state.sight.exact = false;
    tellSliders();
    changed();
    if (isSight) saveSoon();
  });
}
for (const [id, { key }] of Object.entries(SLIDERS)) control(id, (value) => { state.sight[key] = value; });
control("redraw", () => { state.sight.seed += 1; });
control("limit", (value) => { state.limit_ms = LIMITS_MS[value]; }, false);
$("show-false").addEventListener("change", (event) => {
  state.marks_false = event.target.checked;
  changed("picture");
});

export function tellSliders() {
  for (const [id, { key, say }] of Object.entries(SLIDERS)) {
    $(id).value = state.sight[key];
    sayOf(id).textContent = state.sight.exact ? "as given" : say(state.sight[key]);
  }
  sayOf("limit").textContent = `${state.limit_ms} ms`;
}

function tellCounts() {
  const wrong = state.seen.filter((cone) => cone.is_false).length;
  const text = `${state.seen.length} cones seen` + (wrong ? `, ${wrong} of them false` : "") + (state.missed.length ? `; ${state.missed.length} missed` : "");
  $("counts").textContent = text;
  canvas.setAttribute("aria-label", `Course ${state.world.label} seen from above: ${text}`);
}
on("looked", tellCounts);
