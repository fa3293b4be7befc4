// Theme, size and part of the picture.
import { sized } from "../../experiments/report/drawing.mjs";
import { draw, drawKeys } from "./draw.mjs";
import { look } from "./world.mjs";
import { $, canvas, state, view } from "./state.mjs";
import { changed } from "./detect_loop.mjs";

export function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  drawKeys();
  changed("picture");
}
export const darkness = matchMedia("(prefers-color-scheme: dark)");
darkness.addEventListener("change", () => setTheme(darkness.matches ? "dark" : "light"));
$("theme").addEventListener("click", () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));

/** The box of what the car sees. */
export function fitView() {
  const { car, sight, world } = state;
  state.following = true;
  const cones = sight.exact ? [...world.cones] : look(world, car, sight).cones;
  // At least what is near the car, however few cones stand there.
  for (const side of [-10, 10]) cones.push({ x: car.x + 20 * Math.cos(car.yaw) - side * Math.sin(car.yaw), y: car.y + 20 * Math.sin(car.yaw) + side * Math.cos(car.yaw) });
  view.fit([car, ...cones]);
  changed("picture");
}
export function fitAll() {
  state.following = false;
  view.fit([state.car, ...state.world.cones]);
  changed("picture");
}
/** Keeps the car in the picture. */
export function follow(car, isStart = false) {
  if (isStart) state.following = true;
  if (!state.following || state.dragging) return;
  const ahead = 0.35 * Math.min(view.width, view.height) / view.scale;
  const x = car.x + ahead * Math.cos(car.yaw), y = car.y + ahead * Math.sin(car.yaw);
  view.x += (x - view.x) * 0.08;
  view.y += (y - view.y) * 0.08;
}

$("fit").addEventListener("click", fitView);
$("fit-all").addEventListener("click", fitAll);
$("zoom-in").addEventListener("click", () => { view.zoom(1.25); changed("picture"); });
$("zoom-out").addEventListener("click", () => { view.zoom(0.8); changed("picture"); });

let isSized = false;
new ResizeObserver(() => {
  const { width, height } = sized(canvas, 2);
  Object.assign(view, { width, height });
  if (state.world && !isSized) fitView();
  isSized = Boolean(state.world);
  if (state.world) draw();
}).observe(canvas);

