// Courses, and files of scenes and lanes.
import { readBytes } from "./files.mjs";
import { readLink } from "./link.mjs";
import { worldOfCones, worldOfCourse } from "./world.mjs";
import { $, attempt, clients, METHODS, stage, state, tell } from "./state.mjs";
import { changed, times } from "./detect_loop.mjs";
import { ownHash, saveSoon } from "./saved_link.mjs";
import { fitView, follow } from "./picture.mjs";
import { past, snapshot } from "./changes.mjs";
import { turn } from "./method_cards.mjs";
import { tellSliders } from "./sight_controls.mjs";

const COURSE_NAMES = { straight: "Straight", circle: "Circle", curvy: "Curvy", legs: "Parallel legs", tight_hairpins: "Tight hairpins", gates: "Loop with gates", wide: "Wide loop" };
export const FIRST_COURSE = "hairpins", FIRST_PLACE = 0.16;

export function setWorld(world, { car, sight, keepView = false, keepLanes = false } = {}) {
  Object.assign(state, { playing: false, run: null, world, car: { ...(car ?? world.start) }, selected: null, hovered: null, edge: null, file_lanes: [] });
  if (!keepLanes) {
    state.found = {};
    for (const name of Object.keys(times)) times[name] = [];
  }
  if (sight) state.sight = { ...state.sight, ...sight };
  state.original = snapshot();
  past.length = 0;
  tellSliders();
  tell("world");
  if (!keepView) fitView();
  changed();
  saveSoon();
}

export async function chooseCourse(name, seed = 0) {
  const course = await clients.first.ask("course", { name, seed });
  state.file = null;
  const world = worldOfCourse(course, `${COURSE_NAMES[name] ?? name}${seed ? ` ${seed}` : ""}`);
  world.base = name;
  world.seed = seed;
  // Not at the very start: a place where there is something to see.
  const [x, y, yaw] = course.line[Math.floor(course.line.length * (course.closed ? FIRST_PLACE : 0.05))];
  world.start = { x, y, yaw };
  setWorld(world, { sight: { exact: false } });
  nameCourse(name);
}

/** Which course is shown; a course of files and links has no name. */
function nameCourse(name) {
  $("course").value = name;
  $("another").hidden = name === "";
}

async function restoreLine() {
  const [name, seed] = state.world.name.split("@");
  if (state.world.line || ![...$("course").options].some((one) => one.value === name)) return;
  const course = await clients.first.ask("course", { name, seed: Number(seed ?? 0) });
  state.world.line = course.line;
  Object.assign(state.world, { base: name, seed: Number(seed ?? 0) });
  nameCourse(name);
}

export function makeCourses(names) {
  const titled = (name) => COURSE_NAMES[name] ?? name.replaceAll("_", " ").replace(/^./, (letter) => letter.toUpperCase());
  $("course").innerHTML = names.map((name) => `<option value="${name}">${titled(name)}</option>`).join("") + '<option value="" hidden>of a file or a link</option>';
  $("course").addEventListener("change", (event) => attempt(() => chooseCourse(event.target.value)));
  $("another").addEventListener("click", () => attempt(() => chooseCourse(state.world.base, state.world.seed + 1)));
}

export async function openLink(hash) {
  const { world, car, sight, methods } = await readLink(hash.slice(1));
  state.file = null;
  for (const { name } of METHODS) if (state.methods[name] !== methods.includes(name)) turn(name, methods.includes(name));
  nameCourse("");
  setWorld(world, { car, sight });
  await restoreLine();
}
addEventListener("hashchange", () => { if (location.hash !== ownHash && location.hash) attempt(() => openLink(location.hash)); });

export async function openFiles(files) {
  const lanes = [];
  for (const file of files) {
    const read = await readBytes(new Uint8Array(await file.arrayBuffer()), file.name);
    if (read.kind === "lanes") lanes.push(...read.lanes);
    else if (read.kind === "course") {
      state.file = null;
      setWorld(worldOfCones(read.name, read.cones, read.start, read.closed), { sight: { exact: false, rate: 0, noise_m: 0, missed: 0 } });
      nameCourse("");
    } else {
      state.file = { ...read, at: 0 };
      nameCourse("");
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

export function showScene(at, isNew = false) {
  const { file } = state;
  file.at = Math.min(Math.max(at, 0), file.scenes.length - 1);
  const scene = file.scenes[file.at];
  const world = worldOfCones(scene.id, scene.cones.map((cone) => ({ ...cone })), scene.pose);
  world.label = file.name;
  const sight = !isNew ? undefined : file.ahead ? { exact: false, rate: 0, noise_m: 0, missed: 0, range_m: 30 } : { exact: true };
  const isPlaying = state.playing;
  setWorld(world, { sight, keepView: !isNew, keepLanes: !isNew }); // a lane stays until there is the next one
  state.playing = isPlaying;
  state.file_lanes = file.lanes.filter((lane) => lane.scene === scene.id);
  if (!isNew) follow(state.car);
  tell("world");
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
