// A card for each method: on or off, and what it answers.
import { drawKeys } from "./draw.mjs";
import { $, escape, median, METHODS, ms, on, state } from "./state.mjs";
import { changed, detectLoop, doneVersion, times } from "./detect_loop.mjs";
import { explainSoon } from "./explanation.mjs";
import { saveSoon } from "./saved_link.mjs";

export function makeMethods() {
  for (const [i, method] of METHODS.entries()) {
    const box = document.createElement("div");
    box.className = "method";
    box.id = `method-${method.name}`;
    box.innerHTML = `<label><input type="checkbox" ${state.methods[method.name] ? "checked" : ""}>
      <canvas data-key="${method.name}" aria-hidden="true"></canvas>
      <span>${method.name}</span><span class="about">${method.about}</span><span class="time"></span></label><dl></dl>`;
    box.title = `${method.name} on or off (${i + 1})`;
    box.querySelector("input").addEventListener("change", (event) => turn(method.name, event.target.checked));
    $("methods").append(box);
    tellMethod(method.name);
  }
  drawKeys();
}

export function turn(name, isOn) {
  state.methods[name] = isOn;
  $(`method-${name}`).querySelector("input").checked = isOn;
  doneVersion[name] = -1;
  tellMethod(name);
  detectLoop();
  changed("picture");
  saveSoon();
  explainSoon();
}

const STATUS = { found: "a lane", none: "no lane: there is none", stopped: "no lane before a limit", error: "error" };

export function tellMethod(name) {
  const box = $(`method-${name}`), list = box.querySelector("dl");
  const isOn = state.methods[name], found = state.found[name];
  box.classList.toggle("off", !isOn);
  box.querySelector(".about").hidden = isOn && Boolean(found);
  box.querySelector(".time").textContent = isOn && found && found.answer.latency_ms !== undefined ? ms(found.answer.latency_ms) : "";
  if (!isOn || !found) {
    list.replaceChildren();
    return;
  }
  const { answer, line } = found;
  const rows = [];
  const add = (key, value) => rows.push(`<dt>${key}</dt><dd>${value}</dd>`);
  let status = STATUS[answer.status];
  if (answer.status === "found") status = `${answer.left.length} + ${answer.right.length} cones${answer.closed ? ", closed" : ""}${line?.points.length ? `, ${line.length_m.toFixed(0)} m` : ""}`;
  add("lane", status);
  if (answer.stopped_by) add("limit", `stopped by ${answer.stopped_by}`);
  if (answer.message) add("says", escape(answer.message));
  if (answer.confidence !== undefined)
    add("confidence", `<span class="bar" style="color: var(--${METHODS.find((one) => one.name === name).color})"><i style="width: ${answer.confidence * 100}%"></i></span>${(answer.confidence * 100).toFixed(1)} %`);
  if (answer.trusted_m !== undefined && answer.status === "found") add("trusted", `${answer.trusted_m.toFixed(1)} m`);
  if (answer.objective !== undefined) {
    add("objective", answer.objective.toFixed(4));
    add("lower bound", answer.bound.toFixed(4));
    add("optimum", answer.optimal ? '<span class="proven">proven ✓</span>' : `not proven, gap ${(answer.objective - answer.bound).toFixed(4)}`);
  } else if (name === "rld-pair" && answer.status === "none") add("optimum", '<span class="proven">proven: no lane ✓</span>');
  if (times[name]?.length > 1) add(`median of ${times[name].length}`, ms(median(times[name])));
  list.innerHTML = rows.join("");
}
on("answered", tellMethod);
