// The picture: ground, cones, lanes, car, in metres.
import { Drawing, sized } from "../../experiments/report/drawing.mjs";
import { ctx, METHODS, state, view } from "./state.mjs";
import { coneName } from "./world.mjs";

const MARKS = {
  seen: { shape: "triangle", radius: 1, color: "ink", rim: "surface" },
  false: { shape: "cross", radius: 0.72, color: "accent", width: 2.2 },
  missed: { shape: "ring", radius: 1, color: "muted", width: 1.3, dash: [2, 2] },
  away: { shape: "triangle", radius: 0.75, color: "line" },
};
const TRUSTED = { width: 2 }, BEYOND = { width: 1.3, dash: [3, 5] }, BAR = { width: 3 };
const CAR = { color: "ink", rim: "surface", width: 1.5, outline: [[1.3, 0], [0.75, -0.42], [-1.1, -0.6], [-1.1, 0.6], [0.75, 0.42]] };
const LABEL = { rim: "surface", font: "600 12px system-ui, sans-serif" };

const xy = ({ x, y }) => [x, y];

function drawGrid(drawing) {
  const step = [1, 2, 5, 10, 20, 50, 100].find((one) => one * view.scale >= 42) ?? 200;
  const [x0, y1] = view.metres(0, 0), [x1, y0] = view.metres(view.width, view.height);
  drawing.paint({ color: "grid" }, (context) => {
    for (let x = Math.ceil(x0 / step) * step; x <= x1; x += step) {
      const px = Math.round(view.at([x, 0])[0]) + 0.5;
      context.moveTo(px, 0);
      context.lineTo(px, view.height);
    }
    for (let y = Math.ceil(y0 / step) * step; y <= y1; y += step) {
      const py = Math.round(view.at([0, y])[1]) + 0.5;
      context.moveTo(0, py);
      context.lineTo(view.width, py);
    }
  });
  // A scale bar, at the right end of the picture.
  const right = view.width - 14, bottom = view.height - 14;
  drawing.line([view.metres(right - step * view.scale, bottom), view.metres(right, bottom)], { color: "muted" });
  drawing.text(`${step} m`, [right, bottom - 5], { color: "muted", align: "right" });
}

function drawView(drawing, car, range_m) {
  const [px, py] = view.at([car.x, car.y]);
  drawing.paint({ color: "view" }, (context) => context.arc(px, py, range_m * view.scale, -car.yaw - Math.PI / 2, -car.yaw + Math.PI / 2), "fill");
}

/** Half the height of a cone [px]. */
export function coneSize() { return Math.min(Math.max(view.scale * 0.36, 3.6), 9); }

function drawCones(drawing, { seen, missed, world, sight, marks_false, selected, hovered, run }) {
  const size = coneSize(), points = (cones, mark) => drawing.points(cones.map(xy), mark, size);
  if (!sight.exact || run) {
    const known = new Set([...seen, ...missed].map((cone) => cone.id));
    points(world.cones.filter((cone) => !known.has(cone.id)), MARKS.away);
    points(missed, MARKS.missed);
  }
  const isMarked = (cone) => cone.is_false && marks_false;
  points(seen.filter((cone) => !isMarked(cone)), MARKS.seen);
  points(seen.filter(isMarked), { ...MARKS.false, width: Math.max(size * 0.32, 1.5) });
  for (const [id, width] of [[hovered, 1.5], [selected, 2.5]]) {
    const cone = id === null ? null : seen.find((one) => one.id === id) ?? world.cones.find((one) => one.id === id);
    if (!cone) continue;
    drawing.points([xy(cone)], { shape: "ring", radius: size + 6, color: "ink", width });
    const [px, py] = view.at(xy(cone));
    if (id === selected) drawing.text(coneName(id), [px + size + 9, py - size], { ...LABEL, color: "ink" });
  }
}

function drawLane(drawing, mark, { left, right, closed }, place, isFirst) {
  const sides = [left, right].map((ids) => ids.map((id) => place.get(id)).filter(Boolean));
  if (isFirst && sides.every((side) => side.length > 1)) drawing.band(...sides, closed, { color: mark.color, opacity: 0.09 });
  const thin = Math.min(Math.max(view.scale / 12, 0.55), 1);
  for (const side of sides) drawing.line(side, { ...mark, width: mark.width * thin, dash: mark.dash.map((one) => one * thin) }, closed);
}

/** The line to drive along: solid as far as it is trusted, dashed beyond. */
function drawLine(drawing, { points, closed, ...line }, color, label) {
  if (points.length < 2) return;
  const trusted_m = line.trusted_m ?? Infinity, split = points.findIndex((point) => point.s_m > trusted_m);
  const near = split < 0 ? points : points.slice(0, split + 1), end = near.at(-1);
  drawing.line(near.map(xy), { ...TRUSTED, color }, closed && split < 0);
  if (split >= 0) drawing.line(points.slice(Math.max(split - 1, 0)).map(xy), { ...BEYOND, color });
  if (closed && split < 0) return;
  const tip = (left_m) => [end.x - left_m * Math.sin(end.heading_rad), end.y + left_m * Math.cos(end.heading_rad)];
  drawing.line([tip(Math.min(end.width_left_m, 3)), tip(-Math.min(end.width_right_m, 3))], { ...BAR, color });
  if (!label || trusted_m === Infinity) return;
  const [px, py] = view.at(xy(end));
  drawing.text(`trusted ${trusted_m.toFixed(0)} m`,
    [px + 46 * Math.cos(end.heading_rad), py - 20 * Math.sin(end.heading_rad) + 4], { ...LABEL, color, align: "center" });
}

/** Where the handle is that turns the car [px]. */
export function handleOf(car) {
  const [px, py] = view.at([car.x, car.y]), far = Math.max(3 * view.scale, 44);
  return [px + far * Math.cos(car.yaw), py - far * Math.sin(car.yaw)];
}

function drawHandle(drawing, car) {
  const end = view.metres(...handleOf(car));
  drawing.line([[car.x, car.y], end], { color: "muted", dash: [2, 3] });
  drawing.points([end], { shape: "dot", radius: 5.5, color: "surface", rim: "ink", width: 1.5 });
}

function drawRun(drawing, run, place) {
  if (run.plan?.answer.status === "found") drawLane(drawing, { color: "drive", width: 2.5, opacity: 0.8, dash: [] }, run.plan.answer, place, true);
  drawing.line(run.trail, { color: "drive", opacity: 0.55, width: 3 });
  if (run.plan) drawLine(drawing, { ...run.plan.lane, trusted_m: Math.min(run.plan.safe_m, run.plan.lane.length_m) }, "drive", true);
}

/** Draws everything. `state.found`: by method, what was found last. */
export function draw() {
  const drawing = new Drawing(ctx, view), car = state.run?.car ?? state.car;
  drawing.paint({ color: "surface" }, () => ctx.rect(0, 0, view.width, view.height), "fill");
  drawGrid(drawing);
  if (!state.sight.exact || state.run) drawView(drawing, car, state.sight.range_m);
  const place = new Map(state.seen.map((cone) => [cone.id, xy(cone)]));
  if (state.run) drawRun(drawing, state.run, place);
  else {
    const shown = METHODS.filter(({ name }) => state.methods[name] && state.found[name]?.answer.status === "found");
    shown.forEach((method, i) => drawLane(drawing, method, state.found[method.name].answer, place, i === 0));
    for (const lane of state.file_lanes) drawLane(drawing, { color: "drive", width: 2.5, dash: [14, 4, 2, 4] }, lane, place, false);
    shown.filter(({ name }) => state.found[name].line).forEach(({ name, color }, i) => drawLine(drawing, state.found[name].line, color, i === 0));
  }
  drawCones(drawing, state);
  const edge = state.edge?.map((id) => place.get(id));
  if (edge?.every(Boolean)) drawing.line(edge, { color: "accent", width: 3, dash: [6, 4] });
  if (!state.run) drawHandle(drawing, car);
  drawing.body([car.x, car.y], car.yaw, CAR, Math.max(view.scale, 6));
}

/** Draws what the marks and lines of the picture mean, beside their words: a mark, a method or the centre line. */
export function drawKeys() {
  for (const canvas of document.querySelectorAll("canvas[data-key]")) {
    const { context, width, height } = sized(canvas), { key } = canvas.dataset, middle = height / 2, method = METHODS.find(({ name }) => name === key);
    const drawing = new Drawing(context, { scale: 1, at: (point) => point }), line = (from, to, mark) => drawing.line([[from, middle], [to, middle]], mark);
    if (method) line(3, width - 3, { ...method, width: Math.min(method.width, 6) });
    else if (key in MARKS) drawing.points([[width / 2, middle]], MARKS[key], 5);
    else {
      line(1, width / 2, { ...TRUSTED, color: "m0" });
      drawing.line([[width / 2, middle - 5], [width / 2, middle + 5]], { ...BAR, color: "m0" });
      line(width / 2 + 2, width, { ...BEYOND, dash: [2, 2], color: "m0" });
    }
  }
}
