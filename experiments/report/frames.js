// Frames of the report: in the car's frame, centimetres, x ahead, y to the left; the car looks up. The small pictures.
const source = document.getElementById("scene-data"), data = source && JSON.parse(source.textContent);
const marks = JSON.parse(document.getElementById("marks").textContent); // sizes, widths and dashes in pixels, colours as names

/** A line of the track in world coordinates, as the car of the frame sees it. */
function drawTrack(drawing, frame, line, mark, closed) {
  const [px, py, yaw] = frame.p, cos = Math.cos(yaw / 1000), sin = Math.sin(yaw / 1000);
  drawing.line(pairs(line).map(([x, y]) => [cos * (x - px) + sin * (y - py), cos * (y - py) - sin * (x - px)]), mark, closed);
}

/** A side of an answer: it has indices of cones, or positions of its own. */
const sideOf = (frame, side) => (Array.isArray(side) ? side.map((i) => frame.c.slice(2 * i, 2 * i + 2)) : pairs(side.p));

/** What fits the truth, all cones where it has none, and the lanes of some methods on a canvas of that size. */
function around(frame, slots, width, height) {
  const lanes = slots.flatMap((slot) => (frame.a[slot] ? frame.a[slot].slice(0, 2) : []));
  const shown = [...frame.g.slice(0, 2), ...lanes].flatMap((side) => sideOf(frame, side)).concat(frame.g[0].length ? [] : pairs(frame.c), [[0, 0]]);
  const range = (axis) => [Math.min(...shown.map((one) => one[axis])), Math.max(...shown.map((one) => one[axis]))];
  const [near, far] = range(0), [right, left] = range(1);
  const scale = width / (Math.max(left - right, width / height * (far - near), 1200) + 400);
  return { scale, at: ([ahead, side]) => [width / 2 - (side - (left + right) / 2) * scale, height / 2 - (ahead - (near + far) / 2) * scale] };
}

/** A frame with the lanes of some methods. `size` is that of the marks. */
function drawFrame(drawing, frame, slots, size = 1) {
  drawing.band(sideOf(frame, frame.g[0]), sideOf(frame, frame.g[1]), frame.g[2], marks.band);
  // Lanes that lie on one another show as stripes: the first ones are broader.
  const visible = slots.filter((slot) => frame.a[slot]);
  const wider = Math.min(marks.lane.wider, (marks.lane.widest - marks.lane.width) / Math.max(1, visible.length - 1));
  visible.forEach((slot, place) => {
    const [first, second, closed] = frame.a[slot], trusted = frame.a[slot][10], sides = [first, second].map((side) => sideOf(frame, side));
    const isLine = sides[1].length === 0 && !Array.isArray(first); // a centre line alone
    const own = `m${data.methods[slot].color}`, width = marks.lane.width + wider * (visible.length - 1 - place);
    const look = (side) => ({ color: visible.length > 1 || isLine ? own : ["left", "right"][side], width });
    sides.forEach((points, side) => drawing.boundary(points, look(side), closed, data.longest_gap, marks.bridged));
    const known = sides.findIndex((points) => points.length > 1);
    if (!isLine && known >= 0 && sides[1 - known].length === 0)
      drawing.inferred(sides[known], known, data.usual_width, { ...look(1 - known), ...marks.inferred });
    if (trusted !== null && sides.every((points) => points.length > 1)) drawing.across(sides, 100 * trusted, { ...marks.trusted, color: own });
  });
  const points = pairs(frame.c), cones = points.length - frame.f;
  drawing.points(points.slice(0, cones), marks.cone, size);
  drawing.points(points.slice(cones), marks.false, size);
  drawing.points(pairs(frame.m || []), marks.missed, size); // not seen: hollow
  drawing.body([0, 0], 0, marks.car, size);
}

/** The small pictures: a scene with the lane of one method each, those of `data-zoom` around the usable lanes of all. */
const trackOf = new Map((data ? data.laps : []).flatMap((lap) => lap.scenes.map((name) => [name, data.tracks[lap.track]])));
function drawPicture(canvas) {
  const { context, width, height } = sized(canvas);
  if (!width) return;
  const { scene, slot, zoom } = canvas.dataset, frame = data.frames[scene], track = trackOf.get(scene);
  const usable = frame.a.map((_, i) => i).filter((i) => frame.a[i] && frame.a[i][7] === 1);
  const drawing = new Drawing(context, around(frame, zoom ? usable : [Number(slot)], width, height));
  if (track) drawTrack(drawing, frame, track.driven, marks.driven, false);
  drawFrame(drawing, frame, [Number(slot)], 0.55);
}
const pictures = [...document.querySelectorAll("canvas[data-slot]")];
const resized = new ResizeObserver((entries) => entries.forEach((entry) => drawPicture(entry.target)));
for (const canvas of pictures) resized.observe(canvas);
document.addEventListener("themechange", () => pictures.forEach(drawPicture));
