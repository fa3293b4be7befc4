"use strict";
// The scene viewer. Frames are in the car's frame, centimetres: x ahead, y to the left; the car looks up.
(() => {
  const source = document.getElementById("scene-data");
  if (!source) return;
  const data = JSON.parse(source.textContent);
  const marks = data.marks; // sizes, widths and dashes in pixels, colours as names
  const element = (name) => document.getElementById("view-" + name);
  const box = document.getElementById("viewer");
  const scene = element("scene"), map = element("map"), tip = element("tip");
  const state = { lap: data.laps[0], pose: 0, shown: data.methods.map((_, i) => i === 0), timer: null };
  const trackFrames = new Map(); // of each track, what its map shows

  const frame = () => data.frames[state.lap.scenes[state.pose]];
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

  const fit = (width, height) => {
    const reach = 100 * state.lap.range;
    const scale = Math.min(width / (2.04 * reach), height / (1.1 * reach));
    const below = Math.max(0.05 * reach * scale, 18); // room for the car and the distances
    return { scale, x: (ahead, left) => width / 2 - left * scale, y: (ahead) => height - below - ahead * scale };
  };

  const positions = (flat, view) =>
    Array.from({ length: flat.length / 2 }, (_, i) => [view.x(flat[2 * i], flat[2 * i + 1]), view.y(flat[2 * i])]);
  const placed = (view) => positions(frame().c, view);
  const missed = (view) => positions(frame().m || [], view);

  const drawRange = (context, view) => {
    const reach = 100 * state.lap.range;
    context.strokeStyle = color("--grid");
    context.fillStyle = color("--muted");
    context.font = "11px system-ui, sans-serif";
    for (let radius = 1000; radius <= reach + 1; radius += 1000) {
      context.beginPath();
      context.arc(view.x(0, 0), view.y(0), radius * view.scale, Math.PI, 2 * Math.PI);
      context.stroke();
      context.fillText(radius / 100 + " m", view.x(0, -radius) - 28, view.y(0) + 11); // beside the car, where no lane is
    }
  };

  /// The annotated boundaries, and of a run the path that was driven.
  const drawBoundaries = (context, view) => {
    const track = data.tracks[state.lap.track];
    if (!track) return;
    const [px, py, yaw] = frame().p;
    const cos = Math.cos(yaw / 1000), sin = Math.sin(yaw / 1000);
    const drawDashed = (line, stroke, width, dash, closed) => {
      const points = [];
      for (let i = 0; i < line.length; i += 2) {
        const dx = line[i] - px, dy = line[i + 1] - py;
        const ahead = cos * dx + sin * dy;
        points.push([view.x(ahead, cos * dy - sin * dx), view.y(ahead)]);
      }
      context.strokeStyle = stroke;
      context.lineWidth = width;
      context.setLineDash(dash);
      context.beginPath();
      trace(context, points, closed);
      context.stroke();
    };
    const { boundary, driven } = marks;
    for (const side of [track.left, track.right])
      drawDashed(side, color("--" + boundary.color), boundary.width, boundary.dash, track.closed);
    drawDashed(track.driven, color("--" + driven.color), driven.width, driven.dash, false);
    context.setLineDash([]);
  };

  /// A dot, cross or ring, as marks.json has it.
  const drawMark = (context, [x, y], mark) => {
    const { shape, radius } = mark;
    context.lineWidth = mark.width || 1;
    context.strokeStyle = context.fillStyle = color("--" + mark.color);
    context.beginPath();
    if (shape === "cross") {
      context.moveTo(x - radius, y - radius); context.lineTo(x + radius, y + radius);
      context.moveTo(x + radius, y - radius); context.lineTo(x - radius, y + radius);
      context.stroke();
    } else {
      context.arc(x, y, radius, 0, 2 * Math.PI);
      if (shape === "dot") context.fill();
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

  const drawScene = () => {
    const { context, width, height } = prepare(scene);
    const view = fit(width, height), current = frame(), points = placed(view);
    const at = (indices) => indices.map((i) => points[i]);
    /// A side of an answer: indices of cones, or positions of its own.
    const side = (one) => (Array.isArray(one) ? at(one) : positions(one.p, view));
    drawRange(context, view);
    drawBoundaries(context, view);

    const [left, right, closed] = current.g;
    context.fillStyle = color("--" + marks.band.color);
    context.globalAlpha = marks.band.opacity;
    context.beginPath();
    if (closed) {
      trace(context, at(left), true);
      trace(context, at(right), true);
    } else {
      trace(context, [...at(left), ...at(right).reverse()], true);
    }
    context.fill("evenodd");
    context.globalAlpha = 1;

    // Lanes that lie on one another show as stripes: the first ones are broader.
    const visible = data.methods.map((_, i) => i).filter((i) => current.a[i] && state.shown[i]);
    const wider = Math.min(marks.lane.wider, (marks.lane.widest - marks.lane.width) / Math.max(1, visible.length - 1));
    visible.forEach((i, place) => {
      const answer = current.a[i];
      context.lineWidth = marks.lane.width + wider * (visible.length - 1 - place);
      const sides = answer.slice(0, 2).map(side), trusted = answer[10];
      const isLine = sides[1].length === 0 && !Array.isArray(answer[0]); // a centre line alone
      const own = color("--m" + data.methods[i].color);
      const ofSide = (which) => (visible.length > 1 || isLine ? own : color(which === 0 ? "--left" : "--right"));
      sides.forEach((points, which) => {
        context.strokeStyle = ofSide(which);
        strokeSide(context, points, answer[2], data.longest_gap * view.scale);
      });
      const known = sides.findIndex((points) => points.length > 1);
      if (known >= 0 && sides[1 - known].length === 0) {
        context.strokeStyle = ofSide(1 - known);
        strokeInferred(context, sides[known], known, data.usual_width * view.scale);
      }
      context.strokeStyle = own;
      if (trusted !== null && sides.every((points) => points.length > 1))
        strokeTrusted(context, sides, 100 * trusted * view.scale);
    });

    const cones = points.length - current.f;
    points.forEach((point, i) => drawMark(context, point, i < cones ? marks.cone : marks.false));
    for (const point of missed(view)) drawMark(context, point, marks.missed); // what the car does not see is hollow

    context.fillStyle = color("--" + marks.car.color);
    context.beginPath();
    trace(context, marks.car.outline.map(([x, y]) => [view.x(0, 0) + x, view.y(0) + y]), true);
    context.fill();
  };

  /// Map of the whole track: world coordinates, its poses in order.
  const mapOf = () => {
    const { lap } = state;
    if (!trackFrames.has(lap)) {
      const track = data.tracks[lap.track];
      const poses = lap.scenes.map((name) => data.frames[name].p);
      const flat = [...(track ? [...track.left, ...track.right, ...track.driven] : []),
                    ...poses.flatMap(([x, y]) => [x, y])];
      const xs = flat.filter((_, i) => i % 2 === 0), ys = flat.filter((_, i) => i % 2 === 1);
      trackFrames.set(lap, { track, poses, low: [Math.min(...xs), Math.min(...ys)],
                             high: [Math.max(...xs), Math.max(...ys)] });
    }
    return trackFrames.get(lap);
  };

  const mapView = (width, height) => {
    const { low, high } = mapOf();
    const scale = Math.min((width - 12) / Math.max(1, high[0] - low[0]), (height - 12) / Math.max(1, high[1] - low[1]));
    const top = (high[1] - low[1]) * scale;
    return ([x, y]) => [width - 6 - (high[0] - x) * scale, 6 + top - (y - low[1]) * scale];
  };

  const drawMap = () => {
    const { context, width, height } = prepare(map);
    const { track, poses } = mapOf();
    const place = mapView(width, height);
    const lines = track ? [[track.left, "--muted", track.closed], [track.right, "--muted", track.closed],
                           [track.driven, "--accent", false]] : [];
    for (const [line, stroke, closed] of lines) {
      const points = [];
      for (let i = 0; i < line.length; i += 2) points.push(place([line[i], line[i + 1]]));
      context.strokeStyle = color(stroke);
      context.beginPath();
      trace(context, points, closed);
      context.stroke();
    }
    const [x, y] = place(poses[state.pose]);
    context.fillStyle = color("--accent");
    context.beginPath();
    context.arc(x, y, 4.5, 0, 2 * Math.PI);
    context.fill();
  };

  const rows = data.methods.map((method, i) => {
    const row = element("methods").insertRow();
    const head = document.createElement("th");
    head.scope = "row";
    head.innerHTML = '<label><input type="checkbox"><span class="swatch"></span><span></span></label>';
    head.querySelector(".swatch").style.background = `var(--m${method.color})`;
    head.querySelector("label > :last-child").textContent = method.label;
    const toggle = head.querySelector("input");
    toggle.checked = state.shown[i];
    toggle.addEventListener("change", () => { state.shown[i] = toggle.checked; drawScene(); });
    row.append(head);
    const cells = ["usable", "outcome", "number", "accurate", "number", "number", "number"].map((kind) => {
      const cell = row.insertCell();
      if (kind === "number") cell.className = kind;
      return cell;
    });
    return { toggle, cells };
  });

  const yesOrNo = (value) => (value === null ? "–" : value ? "yes" : "no");
  const drawAnswers = () => frame().a.forEach((answer, i) => {
    const texts = answer
      ? [answer[8] === null ? yesOrNo(answer[7]) : "no: " + data.causes[answer[8]], data.categories[answer[5]],
         answer[4] === null ? "–" : (100 * answer[4]).toFixed(1), yesOrNo(answer[6]), answer[3].toPrecision(3),
         answer[9] === null ? "–" : (100 * answer[9]).toFixed(1), answer[10] === null ? "–" : answer[10].toFixed(1)]
      : ["–", "no answer", "–", "–", "–", "–", "–"];
    texts.forEach((text, j) => { rows[i].cells[j].textContent = text; });
  });

  const draw = () => {
    const name = state.lap.scenes[state.pose], current = frame();
    element("pose").max = state.lap.scenes.length - 1;
    element("pose").value = state.pose;
    element("name").textContent = `${state.pose + 1} / ${state.lap.scenes.length}`;
    const cones = current.c.length / 2;
    const unseen = current.m ? `, ${current.m.length / 2} cones missed` : "";
    scene.setAttribute("aria-label",
                       `Scene ${name}: ${cones - current.f} cones, ${current.f} false positives${unseen}`);
    box.dataset.scene = name;
    drawScene();
    drawMap();
    drawAnswers();
  };

  const stop = () => {
    clearInterval(state.timer);
    state.timer = null;
    element("play").textContent = "▶";
  };
  const go = (pose) => {
    state.pose = Math.max(0, Math.min(state.lap.scenes.length - 1, pose));
    tip.hidden = true;
    draw();
  };
  const play = () => {
    if (state.timer) return stop();
    if (state.pose === state.lap.scenes.length - 1) go(0);
    element("play").textContent = "❚❚";
    state.timer = setInterval(() => {
      if (state.pose >= state.lap.scenes.length - 1) stop();
      else go(state.pose + 1);
    }, 1000 / Number(element("speed").value));
  };

  const choices = { track: element("track"), condition: element("condition"), rate: element("rate"),
                    range: element("range") };
  const fill = (select, values, show) => {
    for (const value of new Set(values)) select.add(new Option(show(value), value));
  };
  fill(choices.track, data.laps.map((lap) => lap.track), (track) => track);
  fill(choices.condition, data.laps.map((lap) => lap.condition), (condition) => condition || "none named");
  choices.condition.parentElement.hidden = choices.condition.options.length < 2;
  fill(choices.rate, data.laps.map((lap) => lap.rate).sort((a, b) => a - b), (rate) => (100 * rate).toFixed(1) + " %");
  fill(choices.range, data.laps.map((lap) => lap.range).sort((a, b) => a - b), (range) => range + " m");
  const showLap = (lap, pose) => {
    state.lap = lap;
    for (const key in choices) choices[key].value = lap[key];
    go(pose);
  };
  /// The lap as chosen, at the place where the car is now. Where the page does not have it, one that has what was
  /// chosen last and as much of the rest as there is.
  const choose = (last) => {
    const keys = [last, ...Object.keys(choices).filter((key) => key !== last)];
    const wanted = (lap, key) => String(lap[key]) === choices[key].value;
    const agreement = (lap) => keys.reduce((sum, key, i) => sum + (wanted(lap, key) ? 2 ** (keys.length - i) : 0), 0);
    const best = Math.max(...data.laps.map(agreement));
    const lap = data.laps.find((one) => agreement(one) === best);
    const share = state.lap.track === lap.track ? state.pose / Math.max(1, state.lap.scenes.length - 1) : 0;
    showLap(lap, Math.round(share * (lap.scenes.length - 1)));
  };
  for (const [key, select] of Object.entries(choices)) select.addEventListener("change", () => choose(key));
  const step = (key, by) => {
    const index = choices[key].selectedIndex + by;
    if (index < 0 || index >= choices[key].options.length) return;
    choices[key].selectedIndex = index;
    choose(key);
  };

  element("back").addEventListener("click", () => go(state.pose - 1));
  element("next").addEventListener("click", () => go(state.pose + 1));
  element("play").addEventListener("click", play);
  element("pose").addEventListener("input", (event) => go(Number(event.target.value)));
  element("speed").addEventListener("change", () => { if (state.timer) { stop(); play(); } });

  box.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const own = event.target.tagName; // these have a use of their own for some keys
    if (own === "SELECT" || (own === "INPUT" && event.key.startsWith("Arrow") && event.target.type === "range")) return;
    if (event.key === " " && own !== "DIV") return;
    const digit = Number(event.key) - 1;
    if (event.key === "ArrowRight") go(state.pose + 1);
    else if (event.key === "ArrowLeft") go(state.pose - 1);
    else if (event.key === "ArrowUp") step("rate", 1);
    else if (event.key === "ArrowDown") step("rate", -1);
    else if (event.key === " ") play();
    else if (rows[digit]) rows[digit].toggle.click();
    else return;
    event.preventDefault();
  });
  scene.addEventListener("pointerdown", () => box.focus({ preventScroll: true }));

  scene.addEventListener("pointermove", (event) => {
    const view = fit(scene.clientWidth, scene.clientHeight), { c, f, m = [] } = frame();
    const seen = c.length / 2, flat = [...c, ...m], points = positions(flat, view);
    let nearest = -1, least = 12;
    points.forEach(([x, y], i) => {
      const distance = Math.hypot(x - event.offsetX, y - event.offsetY);
      if (distance < least) { least = distance; nearest = i; }
    });
    tip.hidden = nearest < 0;
    if (tip.hidden) return;
    const kind = nearest >= seen ? "missed cone" : nearest < seen - f ? "cone" : "false positive";
    const ahead = flat[2 * nearest] / 100, left = flat[2 * nearest + 1] / 100;
    tip.textContent = `${kind}, ${ahead.toFixed(2)} m ahead, ` +
      `${Math.abs(left).toFixed(2)} m ${left < 0 ? "right" : "left"}`;
    const [x, y] = points[nearest];
    tip.style.left = Math.max(4, Math.min(x + 10, scene.clientWidth - tip.offsetWidth - 4)) + "px";
    tip.style.top = Math.max(4, y - 28) + "px";
  });
  scene.addEventListener("pointerleave", () => { tip.hidden = true; });
  map.addEventListener("click", (event) => {
    const place = mapView(map.clientWidth, map.clientHeight);
    const distances = mapOf().poses.map((pose) => {
      const [x, y] = place(pose);
      return Math.hypot(x - event.offsetX, y - event.offsetY);
    });
    go(distances.indexOf(Math.min(...distances)));
  });

  const open = (name) => {
    const lap = data.laps.find((one) => one.scenes.includes(name));
    showLap(lap, lap.scenes.indexOf(name));
  };
  for (const button of document.querySelectorAll("[data-open]")) {
    button.addEventListener("click", () => {
      stop();
      open(button.dataset.open);
      box.scrollIntoView();
      box.focus({ preventScroll: true });
    });
  }
  document.addEventListener("themechange", draw);
  addEventListener("resize", draw);
  open(data.start);
})();
