// Theme, size and part of the picture.
import { draw, readColors } from "./draw.mjs";
import { look } from "./world.mjs";
import { $, canvas, ctx, state, view } from "./state.mjs";
import { changed } from "./detect_loop.mjs";

export function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  state.colors = readColors(document.documentElement);
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
  const xs = [car.x, ...cones.map((cone) => cone.x)], ys = [car.y, ...cones.map((cone) => cone.y)];
  view.fit([Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)]);
  changed("picture");
}
export function fitAll() {
  state.following = false;
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
  if (state.world) draw(ctx, view, state, state.colors);
}).observe(canvas);

$("legend").innerHTML = `
  <span><svg viewBox="0 0 18 14"><path d="M9 2l5 9H4z" fill="var(--ink)"/></svg>cone seen</span>
  <span><svg viewBox="0 0 18 14"><path d="M5 3l8 8M13 3l-8 8" stroke="var(--accent)" stroke-width="2.2"/></svg>false</span>
  <span><svg viewBox="0 0 18 14"><circle cx="9" cy="7" r="5" fill="none" stroke="var(--muted)" stroke-width="1.4" stroke-dasharray="2 2"/></svg>missed</span>
  <span><svg viewBox="0 0 18 14"><path d="M9 4l4 6H5z" fill="var(--line)"/></svg>out of view</span>
  <span><svg viewBox="0 0 18 14"><path d="M1 7h9" stroke="var(--m0)" stroke-width="2"/><path d="M10 2v10" stroke="var(--m0)" stroke-width="3"/><path d="M12 7h6" stroke="var(--m0)" stroke-width="1.3" stroke-dasharray="2 2"/></svg>centre line, trusted up to the bar</span>`;
