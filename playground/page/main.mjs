// The page: what is shown, and what a hand, a finger or a key does.
import { Client } from "./client.mjs";
import { coneName, coneSize, draw, handleOf, METHODS, readColors, View } from "./draw.mjs";
import { drive, FRAME_S, frameOf, startRun } from "./drive.mjs";
import { readBytes } from "./files.mjs";
import { readLink, writeLink } from "./link.mjs";
import { DEFAULT_SIGHT, FALSE_IDS, look, newId, sceneOf, worldOfCones, worldOfCourse } from "./world.mjs";

const $ = (id) => document.getElementById(id);
const canvas = $("ground"), stage = $("stage"), ctx = canvas.getContext("2d", { alpha: false });
const LIMITS_MS = [20, 50, 100, 400, 2000];
const EXPLAIN_LIMIT_MS = 2000;
const COURSE_NAMES = { straight: "Straight", circle: "Circle", curvy: "Curvy", legs: "Parallel legs", tight_hairpins: "Tight hairpins", gates: "Loop with gates", wide: "Wide loop" };
const FIRST_COURSE = "hairpins", FIRST_PLACE = 0.16;

// ---- The module ------------------------------------------------------------------------------------------------------------

async function moduleBytes() {
  const packed = Uint8Array.from(atob($("module-bytes").textContent.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

const workerUrl = URL.createObjectURL(new Blob([$("worker-text").textContent], { type: "text/javascript" }));
const makeWorker = () => new Worker(workerUrl);
let client = null;    // lanes and plans
let second = null;    // self-test and explanations, which may take longer

// ---- What is shown ---------------------------------------------------------------------------------------------------------

const view = new View();
const state = {
  world: null, car: { x: 0, y: 0, yaw: 0 }, sight: { ...DEFAULT_SIGHT }, methods: { front: true, clc: false, "rld-pair": false },
  limit_ms: 50, seen: [], missed: [], found: {}, marks_false: true, selected: null, hovered: null, edge: null, run: null,
  file: null, file_lanes: [], original: null,
};
let colors = readColors(document.documentElement);
let version = 0;               // of the scene
const doneVersion = {};        // by method: of the scene that it answered last
const times = {};              // by method: latest latencies
let isLookDue = true, isFrameAsked = false, isDetecting = false;

function changed(what = "scene") {
  if (what === "scene") isLookDue = true;
  if (isFrameAsked) return;
  isFrameAsked = true;
  requestAnimationFrame(frame);
}

function frame(now) {
  isFrameAsked = false;
  measureFrame(now);
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
    tellCounts();
  }
  draw(ctx, view, state, colors);
  if (dragging) changed("picture");
}

/** Asks the methods that are on, the one whose answer is oldest first. While a cone is dragged all of them follow. */
async function detectLoop() {
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
      const found = await client.ask("detect", { scene, method: name, time_limit_ms: state.limit_ms });
      state.found[name] = found;
      (times[name] ??= []).push(found.answer.latency_ms);
      if (times[name].length > 25) times[name].shift();
    } catch (error) {
      state.found[name] = { answer: { status: "error", message: error.message, left: [], right: [] }, line: null };
      showError(error.message);
    }
    doneVersion[name] = asked;
    tellMethod(name);
    changed("picture");
  }
  isDetecting = false;
  document.body.dataset.version = String(version);
  settled.splice(0).forEach((one) => one());
  explainSoon();
}

const settled = [];
const isSettled = () => !isLookDue && METHODS.every(({ name }) => !state.methods[name] || doneVersion[name] === version);
/** Until every method has answered for what is shown. */
const whenSettled = () => (isSettled() ? Promise.resolve() : new Promise((done) => settled.push(done)));

const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];
const ms = (value) => (value < 10 ? value.toFixed(2) : value.toFixed(value < 100 ? 1 : 0)) + " ms";

function showError(message) {
  $("error").hidden = false;
  $("error").firstElementChild.textContent = message;
}
$("error").lastElementChild.addEventListener("click", () => { $("error").hidden = true; });
const onRestart = (reason) => {
  document.body.dataset.restarts = String(Number(document.body.dataset.restarts ?? 0) + 1);
  showError(`The module reported: ${reason}. It was started anew.`);
};

// ---- Methods ---------------------------------------------------------------------------------------------------------------

function makeMethods() {
  for (const [i, method] of METHODS.entries()) {
    const box = document.createElement("div");
    box.className = "method";
    box.id = `method-${method.name}`;
    const width = Math.min(method.width, 6);
    box.innerHTML = `<label><input type="checkbox" ${state.methods[method.name] ? "checked" : ""}>
      <svg viewBox="0 0 48 14" aria-hidden="true"><line x1="3" y1="7" x2="45" y2="7" stroke="var(${method.color})" stroke-width="${width}"
        stroke-dasharray="${method.dash.join(" ")}" stroke-opacity="${method.alpha}" stroke-linecap="${method.dash[0] > 3 ? "butt" : "round"}"/></svg>
      <span>${method.name}</span><span class="about">${method.about}</span><span class="time"></span></label><dl></dl>`;
    box.title = `${method.name} on or off (${i + 1})`;
    box.querySelector("input").addEventListener("change", (event) => turn(method.name, event.target.checked));
    $("methods").append(box);
    tellMethod(method.name);
  }
}

function turn(name, isOn) {
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

function tellMethod(name) {
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
    add("confidence", `<span class="bar" style="color: var(${METHODS.find((one) => one.name === name).color})"><i style="width: ${answer.confidence * 100}%"></i></span>${(answer.confidence * 100).toFixed(1)} %`);
  if (answer.trusted_m !== undefined && answer.status === "found") add("trusted", `${answer.trusted_m.toFixed(1)} m`);
  if (answer.objective !== undefined) {
    add("objective", answer.objective.toFixed(4));
    add("lower bound", answer.bound.toFixed(4));
    add("optimum", answer.optimal ? '<span class="proven">proven ✓</span>' : `not proven, gap ${(answer.objective - answer.bound).toFixed(4)}`);
  } else if (name === "rld-pair" && answer.status === "none") add("optimum", '<span class="proven">proven: no lane ✓</span>');
  if (times[name]?.length > 1) add(`median of ${times[name].length}`, ms(median(times[name])));
  list.innerHTML = rows.join("");
}

const escape = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");

// ---- What the car sees -----------------------------------------------------------------------------------------------------

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

function tellSliders() {
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

// ---- Worlds ----------------------------------------------------------------------------------------------------------------

function setWorld(world, { car, sight, keepView = false, keepLanes = false } = {}) {
  stopRun();
  Object.assign(state, { world, car: { ...(car ?? world.start) }, selected: null, hovered: null, edge: null, file_lanes: [] });
  if (!keepLanes) {
    state.found = {};
    for (const name of Object.keys(times)) times[name] = [];
  }
  if (sight) state.sight = { ...state.sight, ...sight };
  state.original = snapshot();
  past.length = 0;
  tellSliders();
  tellPlaybar();
  isLookDue = true;
  if (!keepView) fitView();
  changed();
  saveSoon();
}

async function chooseCourse(name, seed = 0) {
  const course = await client.ask("course", { name, seed });
  state.file = null;
  const world = worldOfCourse(course, `${COURSE_NAMES[name] ?? name}${seed ? ` ${seed}` : ""}`);
  world.base = name;
  world.seed = seed;
  // Not at the very start: a place where there is something to see.
  const [x, y, yaw] = course.line[Math.floor(course.line.length * (course.closed ? FIRST_PLACE : 0.05))];
  world.start = { x, y, yaw };
  setWorld(world, { sight: { exact: false } });
  $("course").value = name;
  $("another").hidden = false;
}

async function restoreLine() {
  const [name, seed] = state.world.name.split("@");
  if (state.world.line || ![...$("course").options].some((one) => one.value === name)) return;
  const course = await client.ask("course", { name, seed: Number(seed ?? 0) });
  state.world.line = course.line;
  Object.assign(state.world, { base: name, seed: Number(seed ?? 0) });
  $("course").value = name;
  $("another").hidden = false;
}

function makeCourses(names) {
  const titled = (name) => COURSE_NAMES[name] ?? name.replaceAll("_", " ").replace(/^./, (letter) => letter.toUpperCase());
  $("course").innerHTML = names.map((name) => `<option value="${name}">${titled(name)}</option>`).join("") + '<option value="" hidden>of a file or a link</option>';
  $("course").addEventListener("change", (event) => attempt(() => chooseCourse(event.target.value)));
  $("another").addEventListener("click", () => attempt(() => chooseCourse(state.world.base, state.world.seed + 1)));
}

async function attempt(action) {
  try {
    await action();
  } catch (error) {
    showError(error.message);
  }
}

// ---- Files -----------------------------------------------------------------------------------------------------------------

async function openFiles(files) {
  const lanes = [];
  for (const file of files) {
    const read = await readBytes(new Uint8Array(await file.arrayBuffer()), file.name);
    if (read.kind === "lanes") lanes.push(...read.lanes);
    else if (read.kind === "course") {
      state.file = null;
      setWorld(worldOfCones(read.name, read.cones, read.start, read.closed), { sight: { exact: false, rate: 0, noise_m: 0, missed: 0 } });
      $("course").value = "";
      $("another").hidden = true;
    } else {
      state.file = { ...read, at: 0 };
      $("course").value = "";
      $("another").hidden = true;
      showScene(0, true);
    }
  }
  if (lanes.length) {
    if (!state.file) throw new Error("lanes belong to scenes: open the file of the scenes first, or both together");
    state.file.lanes.push(...lanes);
    showScene(state.file.at);
    if (!state.file_lanes.length) throw new Error(`no lane of this file is of scene ${state.file.scenes[state.file.at].id}`);
  }
  $("error").hidden = true;
}

function showScene(at, isNew = false) {
  const { file } = state;
  file.at = Math.min(Math.max(at, 0), file.scenes.length - 1);
  const scene = file.scenes[file.at];
  const world = worldOfCones(scene.id, scene.cones.map((cone) => ({ ...cone })), scene.pose);
  world.label = file.name;
  const sight = !isNew ? undefined : file.ahead ? { exact: false, rate: 0, noise_m: 0, missed: 0, range_m: 30 } : { exact: true };
  const isPlaying = playing;
  setWorld(world, { sight, keepView: !isNew, keepLanes: !isNew }); // a lane stays until there is the next one
  playing = isPlaying;
  state.file_lanes = file.lanes.filter((lane) => lane.scene === scene.id);
  if (!isNew) follow(state.car);
  tellPlaybar();
}

$("file").addEventListener("change", (event) => {
  const files = [...event.target.files];
  event.target.value = "";
  attempt(() => openFiles(files));
});
for (const name of ["dragenter", "dragover"]) {
  addEventListener(name, (event) => {
    event.preventDefault();
    stage.classList.add("dropping");
  });
}
addEventListener("dragleave", (event) => { if (!event.relatedTarget) stage.classList.remove("dropping"); });
addEventListener("drop", (event) => {
  event.preventDefault();
  stage.classList.remove("dropping");
  const files = [...event.dataTransfer.files];
  if (files.length) attempt(() => openFiles(files));
});

// ---- Drive and play --------------------------------------------------------------------------------------------------------

let playing = false;
const speed = () => Number($("speed").value);
const isFile = () => state.file && state.file.scenes.length > 1;

function tellPlaybar() {
  $("frame").hidden = !isFile();
  if (isFile()) {
    $("frame").max = state.file.scenes.length - 1;
    $("frame").value = state.file.at;
  }
  $("play").textContent = playing ? "Pause" : isFile() ? "▶ Play" : state.run && state.run.state === "driving" ? "▶ Go on" : "▶ Drive a lap";
  document.body.dataset.playing = String(playing);
  tellRun();
}

function tellRun() {
  const { run } = state;
  let text = "";
  if (run) {
    const plan = run.plan;
    const end = { finished: `lap finished: ${run.driven_m.toFixed(0)} m in ${run.time_s.toFixed(1)} s`, stopped: "the car stopped", left: "the car left the lane" }[run.state];
    const hit = run.hit.size ? `, ${run.hit.size} ${run.hit.size === 1 ? "cone" : "cones"} hit` : end ? ", no cone hit" : "";
    text = end ? `${end}${hit}` : `${plan?.state ?? "searching"} · ${(run.speed * 3.6).toFixed(0)} km/h · ${run.driven_m.toFixed(0)} m${hit}`;
    if (run.latencies.length > 5) text += ` · plan ${ms(median(run.latencies))}`;
    document.body.dataset.run = run.state;
  } else {
    delete document.body.dataset.run;
    if (state.file) text = `${state.file.at + 1} of ${state.file.scenes.length}: ${state.world?.name ?? ""}${state.file_lanes.length ? ` · stored lane of ${state.file_lanes.map((lane) => lane.method ?? "?").join(", ")}` : ""}`;
  }
  $("run-state").textContent = text;
}

function stopRun() {
  playing = false;
  state.run = null;
}

const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

async function playFile() {
  while (playing && state.file && state.file.at + 1 < state.file.scenes.length) {
    const begun = performance.now();
    showScene(state.file.at + 1);
    await Promise.race([whenSettled(), pause(1000)]);
    await pause(Math.max(100 / speed() - (performance.now() - begun), 4));
  }
  playing = false;
  tellPlaybar();
}

function nearestOnLine(world, car) {
  return world.line.reduce((best, [x, y], i) => {
    const distance = Math.hypot(x - car.x, y - car.y);
    return distance < best.distance ? { distance, i } : best;
  }, { distance: Infinity, i: 0 });
}

async function driveLap() {
  if (!state.run || state.run.state !== "driving") {
    state.run = startRun(state.world, state.car);
    await client.ask("start", { laps: 1 });
    follow(state.run.car, true);
  }
  const { run, world } = state;
  while (playing && state.run === run && run.state === "driving") {
    const begun = performance.now();
    const plan = await client.ask("plan", { frame: frameOf(run, world, state.sight), time_limit_ms: 50 });
    if (state.run !== run) return;
    const before = { ...run.car };
    drive(run, plan, world);
    const after = { ...run.car };
    if (world.line && nearestOnLine(world, after).distance > 4) run.state = "left";
    changed();
    tellRun();
    // The picture goes smoothly from frame to frame.
    const lasts = FRAME_S * 1000 / speed();
    for (;;) {
      const share = Math.min((performance.now() - begun) / lasts, 1);
      const turn = Math.atan2(Math.sin(after.yaw - before.yaw), Math.cos(after.yaw - before.yaw));
      run.car = { x: before.x + share * (after.x - before.x), y: before.y + share * (after.y - before.y), yaw: before.yaw + share * turn };
      follow(run.car);
      changed("picture");
      if (share >= 1) break;
      await new Promise(requestAnimationFrame);
    }
    run.car = after;
  }
  if (state.run === run && run.state !== "driving") playing = false;
  tellPlaybar();
}

/** Keeps the car in the picture; unless the user looks elsewhere. */
let isFollowing = true;
function follow(car, isStart = false) {
  if (isStart) isFollowing = true;
  if (!isFollowing || dragging) return;
  const ahead = 0.35 * Math.min(view.width, view.height) / view.scale;
  const x = car.x + ahead * Math.cos(car.yaw), y = car.y + ahead * Math.sin(car.yaw);
  view.x += (x - view.x) * 0.08;
  view.y += (y - view.y) * 0.08;
}

function togglePlay() {
  playing = !playing;
  tellPlaybar();
  if (!playing) return;
  attempt(async () => {
    if (isFile()) {
      if (state.file.at + 1 >= state.file.scenes.length) showScene(0);
      playing = true;
      tellPlaybar();
      await playFile();
    } else {
      try {
        await driveLap();
      } catch (error) {
        stopRun();
        changed();
        tellPlaybar();
        throw error;
      }
    }
  });
}
$("play").addEventListener("click", togglePlay);
$("back").addEventListener("click", () => {
  if (isFile()) showScene(0);
  else {
    stopRun();
    state.car = { ...state.world.start };
    fitView();
    changed();
  }
  tellPlaybar();
});
$("frame").addEventListener("input", (event) => {
  playing = false;
  showScene(Number(event.target.value));
});

// ---- Changes, undone -------------------------------------------------------------------------------------------------------

const past = [];
const snapshot = () => ({ cones: state.world.cones.map((cone) => ({ ...cone })), gone: [...state.world.gone], car: { ...state.car } });
function remember() {
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
function undo() {
  if (past.length) restore(past.pop());
  $("undo").disabled = past.length === 0;
}
$("undo").addEventListener("click", undo);
$("reset").addEventListener("click", () => {
  remember();
  restore(state.original);
});

/** The cone of the world with this id. A false one becomes a cone of the world when it is touched. */
function ownCone(id) {
  const own = state.world.cones.find((cone) => cone.id === id);
  if (own || id < FALSE_IDS) return own;
  const seen = state.seen.find((cone) => cone.id === id);
  if (!seen) return undefined;
  state.world.gone.add(id);
  const cone = { id: newId({ cones: state.world.cones }), x: seen.x, y: seen.y, color: "unknown", is_false: true };
  state.world.cones.push(cone);
  return cone;
}

function addCone(x, y) {
  remember();
  const cone = { id: newId(state.world), x, y, color: "unknown" };
  state.world.cones.push(cone);
  select(cone.id);
  say(`cone ${coneName(cone.id)} added`);
  changed();
  saveSoon();
}

function deleteCone(id) {
  remember();
  if (id >= FALSE_IDS) state.world.gone.add(id);
  else state.world.cones = state.world.cones.filter((cone) => cone.id !== id);
  if (state.selected === id) select(null);
  state.hovered = null;
  say(`cone ${coneName(id)} deleted`);
  changed();
  saveSoon();
}

const say = (text) => { $("said").textContent = text; };

function select(id) {
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

// ---- Mouse and touch -------------------------------------------------------------------------------------------------------

const pointers = new Map();
let dragging = null;   // {kind, id, ...} of the one pointer that moves something
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
    const [x, y] = view.px(cone.x, cone.y), far = Math.hypot(x - px, y - py);
    if (far <= distance) [best, distance] = [cone.id, far];
  }
  return best;
}

/** The edge of the exact solver's lane that is nearest, as two ids. */
function edgeAt(px, py, reach) {
  const answer = state.found["rld-pair"]?.answer;
  if (!state.methods["rld-pair"] || answer?.status !== "found") return null;
  const place = new Map(state.seen.map((cone) => [cone.id, view.px(cone.x, cone.y)]));
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
    dragging = null;
    const [a, b] = [...pointers.values()];
    pinch = { distance: Math.hypot(a[0] - b[0], a[1] - b[1]), x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2 };
    return;
  }
  if (pointers.size > 2) return;
  const reach = event.pointerType === "touch" ? 24 : 12 + coneSize(view) / 2;
  const id = coneAt(px, py, reach);
  const near = ([x, y], far) => Math.hypot(x - px, y - py) <= far;
  dragging = { kind: "pan", from: [px, py], last: [px, py], id, isMoved: false };
  if (!state.run && near(handleOf(view, state.car), event.pointerType === "touch" ? 24 : 12)) dragging.kind = "turn";
  else if (id !== null) dragging.kind = "cone";
  else if (!state.run && near(view.px(state.car.x, state.car.y), Math.max(1.3 * view.scale, 18))) dragging.kind = "car";
  beginMeasure();
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
    isFollowing = false;
    changed("picture");
    return;
  }
  if (!dragging) return;
  if (!dragging.isMoved) {
    if (Math.hypot(px - dragging.from[0], py - dragging.from[1]) < 4) return;
    dragging.isMoved = true;
    if (dragging.kind !== "pan") remember();
    if (dragging.kind === "cone") dragging.cone = ownCone(dragging.id);
    if (dragging.cone) select(dragging.cone.id);
  }
  const dx = (px - dragging.last[0]) / view.scale, dy = -(py - dragging.last[1]) / view.scale;
  dragging.last = [px, py];
  if (dragging.kind === "pan") {
    view.x -= dx;
    view.y -= dy;
    isFollowing = false;
    changed("picture");
  } else if (dragging.kind === "cone" && dragging.cone) {
    dragging.cone.x += dx;
    dragging.cone.y += dy;
    changed();
  } else if (dragging.kind === "car") {
    state.car.x += dx;
    state.car.y += dy;
    changed();
  } else if (dragging.kind === "turn") {
    const [x, y] = view.metres(px, py);
    state.car.yaw = Math.atan2(y - state.car.y, x - state.car.x);
    changed();
  }
});

function release(event) {
  const [px, py] = placeOf(event);
  pointers.delete(event.pointerId);
  if (pointers.size < 2) pinch = null;
  const drag = dragging;
  dragging = null;
  if (!drag) return;
  endMeasure();
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
  const id = coneAt(px, py, 12 + coneSize(view) / 2);
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

// ---- Keys ------------------------------------------------------------------------------------------------------------------

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

// ---- Why this lane? --------------------------------------------------------------------------------------------------------

let explainTimer = 0, explained = "";
function explainSoon() {
  clearTimeout(explainTimer);
  explainTimer = setTimeout(() => attempt(explain), 70);
}

async function explain() {
  if (dragging || state.run || !second) return;
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
  const told = await second.ask("explain", { scene, cone, edge: state.edge, time_limit_ms: EXPLAIN_LIMIT_MS });
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

// ---- Link, theme, size -----------------------------------------------------------------------------------------------------

let saveTimer = 0, ownHash = "";
function saveSoon() {
  clearTimeout(saveTimer);
  saveTimer = setTimeout(save, 400);
}
async function save() {
  clearTimeout(saveTimer);
  const methods = METHODS.map(({ name }) => name).filter((name) => state.methods[name]);
  ownHash = "#" + await writeLink({ world: state.world, car: state.car, sight: state.sight, methods });
  history.replaceState(null, "", ownHash);
}

async function openLink(hash) {
  const { world, car, sight, methods } = await readLink(hash.slice(1));
  state.file = null;
  for (const { name } of METHODS) if (state.methods[name] !== methods.includes(name)) turn(name, methods.includes(name));
  $("course").value = "";
  $("another").hidden = true;
  setWorld(world, { car, sight });
  await restoreLine();
}
addEventListener("hashchange", () => { if (location.hash !== ownHash && location.hash) attempt(() => openLink(location.hash)); });

$("copy-link").addEventListener("click", () => attempt(async () => {
  await save();
  try {
    await navigator.clipboard.writeText(location.href);
    $("copy-link").textContent = "Copied";
  } catch {
    $("copy-link").textContent = "It is in the address bar";
  }
  setTimeout(() => { $("copy-link").textContent = "Copy link"; }, 2000);
}));

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  colors = readColors(document.documentElement);
  changed("picture");
}
const darkness = matchMedia("(prefers-color-scheme: dark)");
setTheme(darkness.matches ? "dark" : "light");
darkness.addEventListener("change", () => setTheme(darkness.matches ? "dark" : "light"));
$("theme").addEventListener("click", () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));

/** The box of what the car sees. */
function fitView() {
  const { car, sight, world } = state;
  isFollowing = true;
  const cones = sight.exact ? [...world.cones] : look(world, car, sight).cones;
  // At least what is near the car, however few cones stand there.
  for (const side of [-10, 10]) cones.push({ x: car.x + 20 * Math.cos(car.yaw) - side * Math.sin(car.yaw), y: car.y + 20 * Math.sin(car.yaw) + side * Math.cos(car.yaw) });
  const xs = [car.x, ...cones.map((cone) => cone.x)], ys = [car.y, ...cones.map((cone) => cone.y)];
  view.fit([Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)]);
  changed("picture");
}
function fitAll() {
  isFollowing = false;
  const xs = [state.car.x, ...state.world.cones.map((cone) => cone.x)], ys = [state.car.y, ...state.world.cones.map((cone) => cone.y)];
  view.fit([Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)]);
  changed("picture");
}
$("fit").addEventListener("click", fitView);
$("fit-all").addEventListener("click", fitAll);
$("zoom-in").addEventListener("click", () => { view.zoom(1.25); changed("picture"); });
$("zoom-out").addEventListener("click", () => { view.zoom(0.8); changed("picture"); });

let isSized = false;
new ResizeObserver(() => {
  const ratio = Math.min(devicePixelRatio || 1, 2), { clientWidth, clientHeight } = canvas;
  canvas.width = Math.round(clientWidth * ratio);
  canvas.height = Math.round(clientHeight * ratio);
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  view.width = clientWidth;
  view.height = clientHeight;
  if (state.world && !isSized) fitView();
  isSized = Boolean(state.world);
  if (state.world) draw(ctx, view, state, colors);
}).observe(canvas);

$("legend").innerHTML = `
  <span><svg viewBox="0 0 18 14"><path d="M9 2l5 9H4z" fill="var(--ink)"/></svg>cone seen</span>
  <span><svg viewBox="0 0 18 14"><path d="M5 3l8 8M13 3l-8 8" stroke="var(--accent)" stroke-width="2.2"/></svg>false</span>
  <span><svg viewBox="0 0 18 14"><circle cx="9" cy="7" r="5" fill="none" stroke="var(--muted)" stroke-width="1.4" stroke-dasharray="2 2"/></svg>missed</span>
  <span><svg viewBox="0 0 18 14"><path d="M9 4l4 6H5z" fill="var(--line)"/></svg>out of view</span>
  <span><svg viewBox="0 0 18 14"><path d="M1 7h9" stroke="var(--m0)" stroke-width="2"/><path d="M10 2v10" stroke="var(--m0)" stroke-width="3"/><path d="M12 7h6" stroke="var(--m0)" stroke-width="1.3" stroke-dasharray="2 2"/></svg>centre line, trusted up to the bar</span>`;

// ---- Frames while dragging -------------------------------------------------------------------------------------------------

let frames = null;
const beginMeasure = () => { frames = []; };
const measureFrame = (now) => { frames?.push(now); };
function endMeasure() {
  const gaps = (frames ?? []).slice(1).map((now, i) => now - frames[i]);
  frames = null;
  if (gaps.length < 10) return null;
  const mean = gaps.reduce((sum, gap) => sum + gap, 0) / gaps.length;
  const worst = Math.max(...gaps);
  document.body.dataset.framesPerSecond = (1000 / mean).toFixed(1);
  document.body.dataset.longestFrameMs = worst.toFixed(1);
  return { rate: 1000 / mean, worst, count: gaps.length };
}

/** 150 cones, a third of them false, one of them dragged around for two seconds. */
async function measure() {
  const before = { world: state.world, car: state.car, sight: state.sight, file: state.file, original: state.original };
  const cones = [];
  for (let i = 0; i < 50; i++) for (const side of [-1, 1]) cones.push({ id: cones.length + 1, x: 3 + i * 1.1, y: 6 * Math.sin(i / 8) + side * 1.8 });
  for (let i = 0; i < 50; i++) cones.push({ id: cones.length + 1, x: 2 + (i * 37) % 57, y: ((i * 53) % 31) - 15.5, is_false: true });
  state.file = null;
  setWorld(worldOfCones("150 cones", cones, { x: 0, y: 0, yaw: 0.3 }), { sight: { exact: true } });
  const [held] = state.world.cones.slice(20, 21), { x, y } = held;
  dragging = { kind: "measure" };
  beginMeasure();
  const begun = performance.now();
  while (performance.now() - begun < 2000) {
    const angle = (performance.now() - begun) / 150;
    held.x = x + 0.8 * Math.cos(angle);
    held.y = y + 0.8 * Math.sin(angle);
    changed();
    await new Promise(requestAnimationFrame);
  }
  dragging = null;
  const result = endMeasure();
  $("measured").textContent = `${result.rate.toFixed(0)} frames a second, longest ${result.worst.toFixed(0)} ms`;
  setWorld(before.world, { car: before.car });
  Object.assign(state, { sight: before.sight, file: before.file, original: before.original });
  tellSliders();
  tellPlaybar();
  changed();
  return result;
}
$("measure").addEventListener("click", () => attempt(measure));

// ---- Begin -----------------------------------------------------------------------------------------------------------------

async function runSelfTest() {
  const stored = JSON.parse($("stored-scenes").textContent);
  try {
    const { failed, lanes, scenes, median_ms } = await second.ask("selfTest", { stored });
    document.body.dataset.medianMs = median_ms.toFixed(3);
    document.body.dataset.selfTest = failed.length ? `failed: ${failed.join("; ")}` : "passed";
    $("self-test").textContent = failed.length
      ? `The self-test failed: ${failed.length} of ${lanes} lanes are not those of the native program (${failed[0]}).`
      : `Self-test passed: ${lanes} lanes of ${scenes} scenes are those of the native program. front takes ${ms(median_ms)} here, in the median.`;
  } catch (error) {
    document.body.dataset.selfTest = `failed: ${error.message}`;
    $("self-test").textContent = `The self-test failed: ${error.message}`;
  }
}

async function begin() {
  const bytes = await moduleBytes();
  client = new Client(makeWorker, bytes, onRestart);
  second = new Client(makeWorker, bytes, onRestart);
  const { version: number, courses } = await client.describe();
  $("version").textContent = number;
  makeMethods();
  makeCourses(courses);
  $("limit").value = LIMITS_MS.indexOf(state.limit_ms);
  tellSliders();
  const first = courses.includes(FIRST_COURSE) ? FIRST_COURSE : courses[0];
  if (location.hash.length > 1) {
    try {
      await openLink(location.hash);
    } catch (error) {
      showError(error.message);
      await chooseCourse(first);
    }
  } else await chooseCourse(first);
  await whenSettled();
  document.body.dataset.ready = "true";
  for (const name of Object.keys(times)) times[name] = [];
  changed(); // once more, by a module that is warm
  await runSelfTest();
}

/** For tests and the console. */
globalThis.playground = {
  state, view, measure, whenSettled, select, turn, openFiles, save,
  ask: (task, given) => client.ask(task, given),
  place: (id) => { const cone = state.seen.find((one) => one.id === id); return cone && view.px(cone.x, cone.y); },
};

begin().catch((error) => {
  document.body.dataset.selfTest = `failed: ${error.message}`;
  showError(`The page could not start: ${error.message}. It takes a browser of 2023 or newer.`);
});
