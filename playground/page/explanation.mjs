// Why this lane? A cone or an edge of the exact solver, explained.
import { coneName, sceneOf } from "./world.mjs";
import { $, attempt, clients, escape, on, state } from "./state.mjs";
import { version } from "./detect_loop.mjs";

const EXPLAIN_LIMIT_MS = 2000;

let explainTimer = 0, explained = "";
export function explainSoon() {
  clearTimeout(explainTimer);
  explainTimer = setTimeout(() => attempt(explain), 70);
}

on("settled", explainSoon);

async function explain() {
  if (state.dragging || state.run || !clients.second) return;
  const box = $("explanation");
  const cone = state.hovered ?? state.selected;
  if (!state.methods["rld-pair"] || (cone === null && !state.edge)) return;
  const asked = `${version} ${cone} ${state.edge}`;
  if (asked === explained) return;
  explained = asked;
  const scene = sceneOf(state.car, state.seen);
  const known = new Set(scene.cones.map((one) => one.id));
  if (state.edge ? !state.edge.every((id) => known.has(id)) : !known.has(cone)) {
    box.innerHTML = `<p>The car does not see this cone, so it is not in the program.</p>`;
    return;
  }
  const told = await clients.second.ask("explain", { scene, cone, edge: state.edge, time_limit_ms: EXPLAIN_LIMIT_MS });
  if (asked !== explained) return;
  box.innerHTML = told.kind === "cone" ? coneWords(told) : edgeWords(told);
  box.dataset.about = told.kind === "cone" ? String(told.id) : `${told.from} ${told.to}`;
}

const named = (text) => escape(text.replace(/\b[1-9]\d{9}\b/g, (id) => coneName(Number(id))));
const signed = (value) => (value < 0 ? "−" : "+") + Math.abs(value).toFixed(3);

/** What the best of the changes says. */
function changeWords(best, isIn) {
  if (!best) return "<p>There is no lane to compare with.</p>";
  const what = named(best.words);
  if (best.violations.length === 0) {
    return isIn ? `<p>Cheapest change: <b>${what}</b>, which costs <b>${signed(best.cost)}</b>.</p>`
      : `<p>Cheapest lane with it that differs in one place: <b>${what}</b>, which costs <b>${signed(best.cost)}</b>.</p>`;
  }
  const why = best.violations.slice(0, 3).map((one) => `<span class="forbidden">${named(one)}</span>`).join("<br>");
  return isIn ? `<p>It cannot be spared: ${what}, the lane breaks<br>${why}</p>` : `<p>No lane with it differs in one place. ${what[0].toUpperCase()}${what.slice(1)}, the lane breaks<br>${why}</p>`;
}

function priceTable(edges, turns) {
  if (!edges.length) return "";
  const rows = edges.map((edge) => `<tr><td>edge ${coneName(edge.from)}–${coneName(edge.to)}</td><td>${edge.spacing_cost.toFixed(3)}</td><td>${edge.heading_cost.toFixed(3)}</td><td></td><td>${signed(edge.cost)}</td></tr>`)
    .concat(turns.map((turn) => `<tr><td>turn at ${coneName(turn.middle)}</td><td></td><td></td><td>${turn.angle_cost.toFixed(3)}</td><td>${signed(turn.cost)}</td></tr>`));
  return `<table><tr><th></th><th>spacing</th><th>heading</th><th>angle</th><th>cost</th></tr>${rows.join("")}</table>`;
}

function coneWords({ id, role, priced, turns, best }) {
  const head = role === "none" ? `<p><b>Cone ${coneName(id)}</b> is not in the lane of rld-pair.</p>` : `<p><b>Cone ${coneName(id)}</b>, ${role} boundary of rld-pair.</p>`;
  return head + changeWords(best, role !== "none") + priceTable(priced, turns);
}

function edgeWords({ from, to, is_chosen, priced, turns, best }) {
  const head = `<p><b>Edge ${coneName(from)}–${coneName(to)}</b> is ${is_chosen ? "" : "not "}chosen.</p>`;
  const [edge] = priced;
  const forbidden = edge.high_cost ? `<p class="forbidden">(27) forbids it in every lane: its spacing cost ${edge.spacing_cost.toFixed(2)} exceeds s_crit.</p>` : "";
  return head + (forbidden || changeWords(best, is_chosen)) + priceTable(priced, turns);
}
