// What the car sees: sliders and counts.
import { $, canvas, ms, say, state } from "./state.mjs";
import { changed } from "./detect_loop.mjs";
import { saveSoon } from "./saved_link.mjs";

export const LIMITS_MS = [20, 50, 100, 400, 2000];

const percent = (value) => `${Math.round(value * 100)} %`;
const SLIDERS = {
  rate: { key: "rate", say: percent }, noise: { key: "noise_m", say: (value) => `${value.toFixed(2)} m` },
  missed: { key: "missed", say: percent }, range: { key: "range_m", say: (value) => `${value.toFixed(0)} m` },
};
const sayOf = (id) => document.querySelector(`output[for="${id}"]`);

for (const [id, { key }] of Object.entries(SLIDERS)) {
  $(id).addEventListener("input", () => {
    state.sight.exact = false;
    state.sight[key] = Number($(id).value);
    tellSliders();
    changed();
    saveSoon();
  });
}
$("limit").addEventListener("input", () => {
  state.limit_ms = LIMITS_MS[$("limit").value];
  tellSliders();
  changed();
});
$("redraw").addEventListener("click", () => {
  state.sight.seed += 1;
  state.sight.exact = false;
  tellSliders();
  changed();
  saveSoon();
});
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

export function tellCounts() {
  const wrong = state.seen.filter((cone) => cone.is_false).length;
  const text = `${state.seen.length} cones seen` + (wrong ? `, ${wrong} of them false` : "") + (state.missed.length ? `; ${state.missed.length} missed` : "");
  $("counts").textContent = text;
  canvas.setAttribute("aria-label", `Course ${state.world.label} seen from above: ${text}`);
}
