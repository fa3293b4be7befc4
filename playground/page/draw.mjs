// The picture: ground, cones, lanes, car. Coordinates are metres until `view` makes pixels of them.

export const METHODS = [
  { name: "front", color: "--m0", width: 7, alpha: 0.55, dash: [], about: "learned search" },
  { name: "clc", color: "--m1", width: 3.5, alpha: 1, dash: [11, 7], about: "graph search" },
  { name: "rld-pair", color: "--m2", width: 2.5, alpha: 1, dash: [2, 5], about: "exact, proven" },
];

export class View {
  constructor() { Object.assign(this, { x: 0, y: 0, scale: 10, width: 1, height: 1 }); }
  px(x, y) { return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale]; }
  metres(px, py) { return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale]; }
  /** Shows a box; the room at the top is for the tools. */
  fit([x0, y0, x1, y1], margin = 24, top = 44) {
    const wide = Math.max(x1 - x0, 6), high = Math.max(y1 - y0, 6);
    this.scale = Math.min((this.width - 2 * margin) / wide, (this.height - 2 * margin - top) / high, 60);
    this.x = (x0 + x1) / 2;
    this.y = (y0 + y1) / 2 + top / 2 / this.scale;
  }
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.metres(px, py);
    this.scale = Math.min(Math.max(this.scale * factor, 0.8), 120);
    const [nx, ny] = this.metres(px, py);
    this.x += x - nx;
    this.y += y - ny;
  }
}

export function readColors(element) {
  const style = getComputedStyle(element);
  const names = ["--surface", "--raised", "--ink", "--muted", "--grid", "--line", "--accent", "--road", "--view", "--m0", "--m1", "--m2", "--drive"];
  return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(name).trim()]));
}

function trace(ctx, view, points, closed = false) {
  ctx.beginPath();
  points.forEach(([x, y], i) => {
    const [px, py] = view.px(x, y);
    if (i === 0) ctx.moveTo(px, py);
    else ctx.lineTo(px, py);
  });
  if (closed) ctx.closePath();
}

function drawGrid(ctx, view, colors) {
  const step = [1, 2, 5, 10, 20, 50, 100].find((one) => one * view.scale >= 42) ?? 200;
  const [x0, y1] = view.metres(0, 0), [x1, y0] = view.metres(view.width, view.height);
  ctx.strokeStyle = colors["--grid"];
  ctx.lineWidth = 1;
  ctx.beginPath();
  for (let x = Math.ceil(x0 / step) * step; x <= x1; x += step) {
    const px = Math.round(view.px(x, 0)[0]) + 0.5;
    ctx.moveTo(px, 0);
    ctx.lineTo(px, view.height);
  }
  for (let y = Math.ceil(y0 / step) * step; y <= y1; y += step) {
    const py = Math.round(view.px(0, y)[1]) + 0.5;
    ctx.moveTo(0, py);
    ctx.lineTo(view.width, py);
  }
  ctx.stroke();
  // A scale bar, at the right end of the picture.
  const right = view.width - 14, bottom = view.height - 14;
  ctx.strokeStyle = colors["--muted"];
  ctx.beginPath();
  ctx.moveTo(right - step * view.scale, bottom);
  ctx.lineTo(right, bottom);
  ctx.stroke();
  ctx.fillStyle = colors["--muted"];
  ctx.font = "11px system-ui, sans-serif";
  ctx.textAlign = "right";
  ctx.fillText(`${step} m`, right, bottom - 5);
}

function drawView(ctx, view, car, range_m, colors) {
  const [px, py] = view.px(car.x, car.y);
  ctx.beginPath();
  ctx.arc(px, py, range_m * view.scale, -car.yaw - Math.PI / 2, -car.yaw + Math.PI / 2);
  ctx.closePath();
  ctx.fillStyle = colors["--view"];
  ctx.fill();
}

function triangle(ctx, px, py, size) {
  ctx.moveTo(px, py - size);
  ctx.lineTo(px + size * 0.87, py + size * 0.62);
  ctx.lineTo(px - size * 0.87, py + size * 0.62);
  ctx.closePath();
}

/** Half the height of a cone [px]. */
export function coneSize(view) { return Math.min(Math.max(view.scale * 0.36, 3.6), 9); }

function drawCones(ctx, view, state, colors) {
  const { seen, missed, world, sight, marks_false, selected, hovered } = state;
  const size = coneSize(view);
  const seenIds = new Set(seen.map((cone) => cone.id));
  const batch = (cones, draw, paint) => {
    ctx.beginPath();
    for (const cone of cones) {
      const [px, py] = view.px(cone.x, cone.y);
      if (px > -20 && py > -20 && px < view.width + 20 && py < view.height + 20) draw(px, py);
    }
    paint();
  };
  if (!sight.exact || state.run) {
    const missedIds = new Set(missed.map((cone) => cone.id));
    ctx.fillStyle = colors["--line"];
    batch(world.cones.filter((cone) => !seenIds.has(cone.id) && !missedIds.has(cone.id)),
      (px, py) => triangle(ctx, px, py, Math.max(size * 0.75, 2)), () => ctx.fill());
    ctx.strokeStyle = colors["--muted"];
    ctx.lineWidth = 1.3;
    ctx.setLineDash([2, 2]);
    batch(missed, (px, py) => { ctx.moveTo(px + size, py); ctx.arc(px, py, size, 0, 7); }, () => ctx.stroke());
    ctx.setLineDash([]);
  }
  const isMarked = (cone) => cone.is_false && marks_false;
  ctx.fillStyle = colors["--ink"];
  ctx.strokeStyle = colors["--surface"];
  ctx.lineWidth = 1;
  batch(seen.filter((cone) => !isMarked(cone)), (px, py) => triangle(ctx, px, py, size), () => { ctx.fill(); ctx.stroke(); });
  ctx.strokeStyle = colors["--accent"];
  ctx.lineWidth = Math.max(size * 0.32, 1.5);
  const arm = size * 0.72;
  batch(seen.filter(isMarked), (px, py) => {
    ctx.moveTo(px - arm, py - arm);
    ctx.lineTo(px + arm, py + arm);
    ctx.moveTo(px + arm, py - arm);
    ctx.lineTo(px - arm, py + arm);
  }, () => ctx.stroke());
  for (const [id, width] of [[hovered, 1.5], [selected, 2.5]]) {
    const cone = id === null ? null : seen.find((one) => one.id === id) ?? world.cones.find((one) => one.id === id);
    if (!cone) continue;
    const [px, py] = view.px(cone.x, cone.y);
    ctx.strokeStyle = colors["--ink"];
    ctx.lineWidth = width;
    ctx.beginPath();
    ctx.arc(px, py, size + 6, 0, 7);
    ctx.stroke();
    if (id === selected) {
      ctx.font = "600 12px system-ui, sans-serif";
      ctx.textAlign = "left";
      ctx.lineWidth = 3;
      ctx.strokeStyle = colors["--surface"];
      const name = coneName(id);
      ctx.strokeText(name, px + size + 9, py - size);
      ctx.fillStyle = colors["--ink"];
      ctx.fillText(name, px + size + 9, py - size);
    }
  }
}

/** Ids of false cones are long numbers, which say nothing. */
export const coneName = (id) => (id >= 1_000_000_000 ? `F${(id - 1_000_000_000).toString(36).toUpperCase()}` : String(id));

function drawLane(ctx, view, method, found, place, colors, isFirst) {
  const color = colors[method.color];
  const sides = [found.answer.left, found.answer.right].map((ids) => ids.map((id) => place.get(id)).filter(Boolean).map(({ x, y }) => [x, y]));
  const { closed } = found.answer;
  if (isFirst && sides[0].length > 1 && sides[1].length > 1) {
    ctx.globalAlpha = 0.09;
    ctx.fillStyle = color;
    if (closed) {
      ctx.beginPath();
      for (const side of sides) {
        side.forEach(([x, y], i) => (i ? ctx.lineTo(...view.px(x, y)) : ctx.moveTo(...view.px(x, y))));
        ctx.closePath();
      }
      ctx.fill("evenodd");
    } else {
      trace(ctx, view, [...sides[0], ...[...sides[1]].reverse()], true);
      ctx.fill();
    }
  }
  const thin = Math.min(Math.max(view.scale / 12, 0.55), 1);
  ctx.globalAlpha = method.alpha;
  ctx.strokeStyle = color;
  ctx.lineWidth = method.width * thin;
  ctx.lineJoin = ctx.lineCap = method.dash.length && method.dash[0] > 3 ? "butt" : "round";
  ctx.setLineDash(method.dash.map((one) => one * thin));
  for (const side of sides) {
    if (side.length < 2) continue;
    trace(ctx, view, side, closed);
    ctx.stroke();
  }
  ctx.setLineDash([]);
  ctx.globalAlpha = 1;
}

/** The line to drive along: solid as far as it is trusted, dashed beyond. */
function drawLine(ctx, view, line, color, colors, label) {
  const { points, trusted_m } = line;
  if (points.length < 2) return;
  const trusted = trusted_m ?? Infinity;
  const split = points.findIndex((point) => point.s_m > trusted);
  const near = split < 0 ? points : points.slice(0, split + 1), far = split < 0 ? [] : points.slice(Math.max(split - 1, 0));
  const xy = (list) => list.map(({ x, y }) => [x, y]);
  ctx.strokeStyle = color;
  ctx.lineWidth = 2;
  trace(ctx, view, xy(near), line.closed && split < 0);
  ctx.stroke();
  ctx.lineWidth = 1.3;
  ctx.setLineDash([3, 5]);
  trace(ctx, view, xy(far));
  ctx.stroke();
  ctx.setLineDash([]);
  if (line.closed && split < 0) return;
  const end = near.at(-1), across = end.heading_rad + Math.PI / 2;
  const tip = (metres) => view.px(end.x + metres * Math.cos(across), end.y + metres * Math.sin(across));
  ctx.lineWidth = 3;
  ctx.beginPath();
  ctx.moveTo(...tip(Math.min(end.width_left_m, 3)));
  ctx.lineTo(...tip(-Math.min(end.width_right_m, 3)));
  ctx.stroke();
  if (!label || trusted_m === undefined) return;
  const [px, py] = view.px(end.x, end.y);
  ctx.font = "600 12px system-ui, sans-serif";
  ctx.textAlign = "center";
  ctx.lineWidth = 4;
  ctx.strokeStyle = colors["--surface"];
  const dx = Math.cos(end.heading_rad) * 46, dy = -Math.sin(end.heading_rad) * 20;
  const words = `trusted ${trusted_m.toFixed(0)} m`;
  ctx.strokeText(words, px + dx, py + dy + 4);
  ctx.fillStyle = color;
  ctx.fillText(words, px + dx, py + dy + 4);
}

function drawCar(ctx, view, car, colors) {
  const [px, py] = view.px(car.x, car.y);
  const unit = Math.max(view.scale, 6);
  ctx.save();
  ctx.translate(px, py);
  ctx.rotate(-car.yaw);
  ctx.fillStyle = colors["--ink"];
  ctx.strokeStyle = colors["--surface"];
  ctx.lineWidth = 1.5;
  ctx.beginPath();
  ctx.moveTo(1.3 * unit, 0);
  ctx.lineTo(0.75 * unit, -0.42 * unit);
  ctx.lineTo(-1.1 * unit, -0.6 * unit);
  ctx.lineTo(-1.1 * unit, 0.6 * unit);
  ctx.lineTo(0.75 * unit, 0.42 * unit);
  ctx.closePath();
  ctx.fill();
  ctx.stroke();
  ctx.restore();
}

/** Where the handle is that turns the car [px]. */
export function handleOf(view, car) {
  const [px, py] = view.px(car.x, car.y);
  const far = Math.max(3 * view.scale, 44);
  return [px + far * Math.cos(car.yaw), py - far * Math.sin(car.yaw)];
}

function drawHandle(ctx, view, car, colors) {
  const [hx, hy] = handleOf(view, car);
  const [px, py] = view.px(car.x, car.y);
  ctx.strokeStyle = colors["--muted"];
  ctx.lineWidth = 1;
  ctx.setLineDash([2, 3]);
  ctx.beginPath();
  ctx.moveTo(px, py);
  ctx.lineTo(hx, hy);
  ctx.stroke();
  ctx.setLineDash([]);
  ctx.fillStyle = colors["--surface"];
  ctx.strokeStyle = colors["--ink"];
  ctx.lineWidth = 1.5;
  ctx.beginPath();
  ctx.arc(hx, hy, 5.5, 0, 7);
  ctx.fill();
  ctx.stroke();
}

function drawEdge(ctx, view, edge, place, colors) {
  const [a, b] = edge.map((id) => place.get(id));
  if (!a || !b) return;
  ctx.strokeStyle = colors["--accent"];
  ctx.lineWidth = 3;
  ctx.setLineDash([6, 4]);
  trace(ctx, view, [[a.x, a.y], [b.x, b.y]]);
  ctx.stroke();
  ctx.setLineDash([]);
}

function drawRun(ctx, view, run, place, colors) {
  const planned = { color: "--drive", width: 2.5, alpha: 0.8, dash: [] };
  if (run.plan?.answer.status === "found") drawLane(ctx, view, planned, { answer: run.plan.answer }, place, colors, true);
  ctx.strokeStyle = colors["--drive"];
  ctx.globalAlpha = 0.55;
  ctx.lineWidth = 3;
  trace(ctx, view, run.trail);
  ctx.stroke();
  ctx.globalAlpha = 1;
  if (run.plan) drawLine(ctx, view, { ...run.plan.lane, trusted_m: Math.min(run.plan.safe_m, run.plan.lane.length_m) }, colors["--drive"], colors, true);
}

/** Draws everything. `state.found`: by method, what was found last. */
export function draw(ctx, view, state, colors) {
  ctx.fillStyle = colors["--surface"];
  ctx.fillRect(0, 0, view.width, view.height);
  drawGrid(ctx, view, colors);
  const car = state.run?.car ?? state.car;
  if (!state.sight.exact || state.run) drawView(ctx, view, car, state.sight.range_m, colors);
  const place = new Map(state.seen.map((cone) => [cone.id, cone]));
  let isFirst = true;
  if (!state.run) {
    for (const method of METHODS) {
      const found = state.found[method.name];
      if (!state.methods[method.name] || found?.answer.status !== "found") continue;
      drawLane(ctx, view, method, found, place, colors, isFirst);
      isFirst = false;
    }
    for (const lane of state.file_lanes ?? []) {
      const loaded = { name: lane.method, color: "--drive", width: 2.5, alpha: 1, dash: [14, 4, 2, 4] };
      drawLane(ctx, view, loaded, { answer: lane }, place, colors, false);
    }
    let label = true;
    for (const method of METHODS) {
      const found = state.found[method.name];
      if (!state.methods[method.name] || !found?.line || found.answer.status !== "found") continue;
      drawLine(ctx, view, found.line, colors[method.color], colors, label);
      label = false;
    }
  } else {
    drawRun(ctx, view, state.run, place, colors);
  }
  drawCones(ctx, view, state, colors);
  if (state.edge) drawEdge(ctx, view, state.edge, place, colors);
  if (!state.run) drawHandle(ctx, view, car, colors);
  drawCar(ctx, view, car, colors);
}
