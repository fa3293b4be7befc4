"use strict";
// What the viewer, the small pictures and the race are drawn by. Frames are in the car's frame, centimetres: x ahead, y to
// the left; the car looks up.
const drawing = (() => {
  const source = document.getElementById("scene-data");
  const data = source && JSON.parse(source.textContent);
  const marks = JSON.parse(document.getElementById("marks").textContent); // sizes, widths and dashes in pixels, colours as names
  const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  /// Canvas sized to the screen's pixels, and its context in CSS pixels.
  const prepare = (canvas) => {
    const ratio = devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = canvas;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.lineJoin = "round";
    return { context, width, height };
  };

  const trace = (context, points, closed) => {
    points.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
    if (closed && points.length) context.closePath();
  };

  const positions = (flat, view) =>
    Array.from({ length: flat.length / 2 }, (_, i) => [view.x(flat[2 * i], flat[2 * i + 1]), view.y(flat[2 * i], flat[2 * i + 1])]);

  /// A dot, cross or ring, as marks.json has it.
  const drawMark = (context, [x, y], mark, size = 1) => {
    const radius = mark.radius * size;
    context.lineWidth = mark.width || 1;
    context.strokeStyle = context.fillStyle = color("--" + mark.color);
    context.beginPath();
    if (mark.shape === "cross") {
      context.moveTo(x - radius, y - radius); context.lineTo(x + radius, y + radius);
      context.moveTo(x + radius, y - radius); context.lineTo(x - radius, y + radius);
      context.stroke();
    } else {
      context.arc(x, y, radius, 0, 2 * Math.PI);
      if (mark.shape === "dot") context.fill();
      else context.stroke();
    }
  };

  /// A boundary, dashed where it bridges a gap.
  const strokeSide = (context, points, closed, longest) => {
    const line = closed && points.length > 2 ? [...points, points[0]] : points;
    const far = ([ax, ay], [bx, by]) => Math.hypot(bx - ax, by - ay) > longest;
    for (const bridged of [false, true]) {
      context.setLineDash(bridged ? marks.bridged.dash : []);
      context.beginPath();
      for (let i = 1; i < line.length; ++i) {
        if (far(line[i - 1], line[i]) !== bridged) continue;
        if (i === 1 || bridged || far(line[i - 2], line[i - 1])) context.moveTo(...line[i - 1]);
        context.lineTo(...line[i]);
      }
      context.stroke();
    }
    context.setLineDash([]);
  };

  /// A boundary beside one that is known alone, at the usual width.
  const strokeInferred = (context, points, known, width) => {
    const left = known === 0 ? -width : width;
    context.setLineDash(marks.inferred.dash);
    context.beginPath();
    trace(context, points.map(([x, y], i) => {
      const [ax, ay] = points[Math.max(0, i - 1)], [bx, by] = points[Math.min(points.length - 1, i + 1)];
      const length = Math.hypot(bx - ax, by - ay) || 1;
      return [x + left * (by - ay) / length, y - left * (bx - ax) / length];
    }), false);
    context.stroke();
    context.setLineDash([]);
  };

  /// Where a boundary has that length; its end where it is shorter.
  const pointAt = (points, length) => {
    for (let i = 1; i < points.length; ++i) {
      const [ax, ay] = points[i - 1], [bx, by] = points[i];
      const step = Math.hypot(bx - ax, by - ay);
      if (step >= length && step > 0) return [ax + (bx - ax) * length / step, ay + (by - ay) * length / step];
      length -= step;
    }
    return points[points.length - 1];
  };

  /// Across the lane, where it is trusted no farther.
  const strokeTrusted = (context, sides, length) => {
    context.lineWidth = marks.trusted.width;
    context.beginPath();
    trace(context, sides.map((points) => pointAt(points, length)), false);
    context.stroke();
  };

  /// A line of the track in world coordinates, as the car of the frame sees it.
  const strokeTrack = (context, view, frame, line, mark, closed) => {
    const [px, py, yaw] = frame.p, cos = Math.cos(yaw / 1000), sin = Math.sin(yaw / 1000), seen = [];
    for (let i = 0; i < line.length; i += 2) {
      const dx = line[i] - px, dy = line[i + 1] - py;
      seen.push(cos * dx + sin * dy, cos * dy - sin * dx);
    }
    context.strokeStyle = color("--" + mark.color);
    context.lineWidth = mark.width;
    context.setLineDash(mark.dash);
    context.beginPath();
    trace(context, positions(seen, view), closed);
    context.stroke();
    context.setLineDash([]);
  };

  /// A side of an answer as flat positions: it has indices of cones, or positions of its own.
  const flatSide = (frame, side) => (Array.isArray(side) ? side.flatMap((i) => frame.c.slice(2 * i, 2 * i + 2)) : side.p);

  /// What fits the truth, all cones where it has none, and the lanes of some methods on a canvas of that size.
  const around = (frame, slots, width, height) => {
    const lanes = slots.flatMap((slot) => (frame.a[slot] ? frame.a[slot].slice(0, 2) : []));
    const flat = [...frame.g.slice(0, 2), ...lanes].flatMap((side) => flatSide(frame, side));
    const shown = [...flat, ...(frame.g[0].length ? [] : frame.c), 0, 0];
    const range = (first) => {
      const values = shown.filter((_, i) => i % 2 === first);
      return [Math.min(...values), Math.max(...values)];
    };
    const [near, far] = range(0), [right, left] = range(1), aspect = width / height;
    const scale = width / (Math.max(left - right, aspect * (far - near), 1200) + 400);
    return { scale, x: (_, side) => width / 2 - (side - (left + right) / 2) * scale,
             y: (ahead) => height / 2 - (ahead - (near + far) / 2) * scale };
  };

  /// A frame with the lanes of some methods. `size` is that of the marks.
  const drawFrame = (context, view, frame, slots, size = 1) => {
    const points = positions(frame.c, view);
    const side = (one) => positions(flatSide(frame, one), view);
    const [left, right, closed] = frame.g.map((one) => (Array.isArray(one) ? side(one) : one));
    context.fillStyle = color("--" + marks.band.color);
    context.globalAlpha = marks.band.opacity;
    context.beginPath();
    if (closed) {
      trace(context, left, true);
      trace(context, right, true);
    } else {
      trace(context, [...left, ...right.reverse()], true);
    }
    context.fill("evenodd");
    context.globalAlpha = 1;

    // Lanes that lie on one another show as stripes: the first ones are broader.
    const visible = slots.filter((slot) => frame.a[slot]);
    const wider = Math.min(marks.lane.wider, (marks.lane.widest - marks.lane.width) / Math.max(1, visible.length - 1));
    visible.forEach((i, place) => {
      const answer = frame.a[i];
      context.lineWidth = marks.lane.width + wider * (visible.length - 1 - place);
      const sides = answer.slice(0, 2).map(side), trusted = answer[10];
      const isLine = sides[1].length === 0 && !Array.isArray(answer[0]); // a centre line alone
      const own = color("--m" + data.methods[i].color);
      const ofSide = (which) => (visible.length > 1 || isLine ? own : color(which === 0 ? "--left" : "--right"));
      sides.forEach((line, which) => {
        context.strokeStyle = ofSide(which);
        strokeSide(context, line, answer[2], data.longest_gap * view.scale);
      });
      const known = sides.findIndex((line) => line.length > 1);
      if (!isLine && known >= 0 && sides[1 - known].length === 0) {
        context.strokeStyle = ofSide(1 - known);
        strokeInferred(context, sides[known], known, data.usual_width * view.scale);
      }
      context.strokeStyle = own;
      if (trusted !== null && sides.every((line) => line.length > 1))
        strokeTrusted(context, sides, 100 * trusted * view.scale);
    });

    const cones = points.length - frame.f;
    points.forEach((point, i) => drawMark(context, point, i < cones ? marks.cone : marks.false, size));
    for (const point of positions(frame.m || [], view)) drawMark(context, point, marks.missed, size); // not seen: hollow

    context.fillStyle = color("--" + marks.car.color);
    context.beginPath();
    trace(context, marks.car.outline.map(([x, y]) => [view.x(0, 0) + size * x, view.y(0) + size * y]), true);
    context.fill();
  };

  /// The small pictures: a scene with the lane of one method each, those of `data-zoom` around the usable lanes of all.
  const tracks = new Map((data ? data.laps : []).flatMap((lap) => lap.scenes.map((name) => [name, data.tracks[lap.track]])));
  const drawPicture = (canvas) => {
    const { context, width, height } = prepare(canvas);
    if (!width) return;
    const { scene, slot, zoom } = canvas.dataset, frame = data.frames[scene], track = tracks.get(scene);
    const usable = frame.a.map((_, i) => i).filter((i) => frame.a[i] && frame.a[i][7] === 1);
    const view = around(frame, zoom ? usable : [Number(slot)], width, height);
    if (track) strokeTrack(context, view, frame, track.driven, marks.driven, false);
    drawFrame(context, view, frame, [Number(slot)], 0.55);
  };
  const pictures = [...document.querySelectorAll("canvas[data-slot]")];
  const resized = new ResizeObserver((entries) => entries.forEach((entry) => drawPicture(entry.target)));
  for (const canvas of pictures) resized.observe(canvas);
  document.addEventListener("themechange", () => pictures.forEach(drawPicture));

  return { data, marks, color, prepare, trace, positions, drawMark, strokeTrack, drawFrame };
})();
