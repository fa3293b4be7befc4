// Frames while a cone is dragged.
import { worldOfCones } from "./world.mjs";
import { $, attempt, ms, state } from "./state.mjs";
import { changed } from "./detect_loop.mjs";
import { tellSliders } from "./sight_controls.mjs";
import { setWorld } from "./worlds.mjs";
import { tellPlaybar } from "./playback.mjs";

let frames = null;
export const beginMeasure = () => { frames = []; };
export const measureFrame = (now) => { frames?.push(now); };
export function endMeasure() {
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
export async function measure() {
  const before = { world: state.world, car: state.car, sight: state.sight, file: state.file, original: state.original };
  const cones = [];
  for (let i = 0; i < 50; i++) for (const side of [-1, 1]) cones.push({ id: cones.length + 1, x: 3 + i * 1.1, y: 6 * Math.sin(i / 8) + side * 1.8 });
  for (let i = 0; i < 50; i++) cones.push({ id: cones.length + 1, x: 2 + (i * 37) % 57, y: ((i * 53) % 31) - 15.5, is_false: true });
  state.file = null;
  setWorld(worldOfCones("150 cones", cones, { x: 0, y: 0, yaw: 0.3 }), { sight: { exact: true } });
  const [held] = state.world.cones.slice(20, 21), { x, y } = held;
  state.dragging = { kind: "measure" };
  beginMeasure();
  const begun = performance.now();
  while (performance.now() - begun < 2000) {
    const angle = (performance.now() - begun) / 150;
    held.x = x + 0.8 * Math.cos(angle);
    held.y = y + 0.8 * Math.sin(angle);
    changed();
    await new Promise(requestAnimationFrame);
  }
  state.dragging = null;
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
