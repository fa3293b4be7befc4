// Frames while a cone is dragged.
import { worldOfCones } from "./world.mjs";
import { $, attempt, on, state, tell } from "./state.mjs";
import { changed } from "./detect_loop.mjs";
import { tellSliders } from "./sight_controls.mjs";
import { setWorld } from "./worlds.mjs";

let frames = [];
on("frame", (now) => { if (state.dragging?.kind === "measure") frames.push(now); });

/** 150 cones, a third of them false, one of them dragged around for two seconds. */
export async function measure() {
  const before = { world: state.world, car: state.car, sight: state.sight, file: state.file, original: state.original };
  const cones = [];
  for (let i = 0; i < 50; i++) for (const side of [-1, 1]) cones.push({ id: cones.length + 1, x: 3 + i * 1.1, y: 6 * Math.sin(i / 8) + side * 1.8 });
  for (let i = 0; i < 50; i++) cones.push({ id: cones.length + 1, x: 2 + (i * 37) % 57, y: ((i * 53) % 31) - 15.5, is_false: true });
  state.file = null;
  setWorld(worldOfCones("150 cones", cones, { x: 0, y: 0, yaw: 0.3 }), { sight: { exact: true } });
  const held = state.world.cones[20], { x, y } = held, begun = performance.now();
  state.dragging = { kind: "measure" };
  frames = [];
  while (performance.now() - begun < 2000) {
    const angle = (performance.now() - begun) / 150;
    Object.assign(held, { x: x + 0.8 * Math.cos(angle), y: y + 0.8 * Math.sin(angle) });
    changed();
    await new Promise(requestAnimationFrame);
  }
  state.dragging = null;
  const rate = 1000 * (frames.length - 1) / (frames.at(-1) - frames[0]), worst = Math.max(...frames.slice(1).map((now, i) => now - frames[i]));
  $("measured").textContent = `${rate.toFixed(0)} frames a second, longest ${worst.toFixed(0)} ms`;
  setWorld(before.world, { car: before.car });
  Object.assign(state, { sight: before.sight, file: before.file, original: before.original });
  tellSliders();
  tell("world");
  changed();
  return { rate, worst };
}
$("measure").addEventListener("click", () => attempt(measure));
