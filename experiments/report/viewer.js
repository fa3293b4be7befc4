// The scene viewer.
(() => {
  if (!data) return;
  const element = (name) => document.getElementById("view-" + name);
  const box = document.getElementById("viewer");
  const scene = element("scene"), map = element("map"), tip = element("tip");
  const state = { lap: data.laps[0], pose: 0, shown: data.methods.map((_, i) => i === 0), timer: null };
  const trackFrames = new Map(); // of each track, what its map shows

  const frame = () => data.frames[state.lap.scenes[state.pose]];

  const fit = (width, height) => {
    const reach = 100 * state.lap.range;
    const scale = Math.min(width / (2.04 * reach), height / (1.1 * reach));
    const below = Math.max(0.05 * reach * scale, 18); // room for the car and the distances
    return { scale, at: ([ahead, left]) => [width / 2 - left * scale, height - below - ahead * scale] };
  };

  const drawRange = (drawing) => {
    const reach = 100 * state.lap.range, [x, y] = drawing.view.at([0, 0]);
    for (let radius = 1000; radius <= reach + 1; radius += 1000) {
      drawing.paint({ color: "grid" }, (context) => context.arc(x, y, radius * drawing.view.scale, Math.PI, 2 * Math.PI));
      drawing.text(radius / 100 + " m", [x + radius * drawing.view.scale - 28, y + 11], { color: "muted" }); // beside the car, where no lane is
    }
  };

  const drawScene = () => {
    const { context, width, height } = sized(scene);
    const drawing = new Drawing(context, fit(width, height)), track = data.tracks[state.lap.track];
    drawRange(drawing);
    if (track) { // the annotated boundaries, and of a run the path that was driven
      for (const side of [track.left, track.right]) drawTrack(drawing, frame(), side, marks.boundary, track.closed);
      drawTrack(drawing, frame(), track.driven, marks.driven, false);
    }
    drawFrame(drawing, frame(), data.methods.map((_, i) => i).filter((i) => state.shown[i]));
  };

  /// Map of the whole track: world coordinates, its poses in order.
  const mapOf = () => {
    const { lap } = state;
    if (!trackFrames.has(lap)) {
      const track = data.tracks[lap.track], poses = lap.scenes.map((name) => data.frames[name].p.slice(0, 2));
      const all = [...(track ? pairs([...track.left, ...track.right, ...track.driven]) : []), ...poses];
      const ends = (of) => [0, 1].map((axis) => of(...all.map((point) => point[axis])));
      trackFrames.set(lap, { track, poses, low: ends(Math.min), high: ends(Math.max) });
    }
    return trackFrames.get(lap);
  };

  const mapView = (width, height) => {
    const { low, high } = mapOf();
    const scale = Math.min((width - 12) / Math.max(1, high[0] - low[0]), (height - 12) / Math.max(1, high[1] - low[1]));
    return { scale, at: ([x, y]) => [width - 6 - (high[0] - x) * scale, 6 + (high[1] - y) * scale] };
  };

  const drawMap = () => {
    const { context, width, height } = sized(map), { track, poses } = mapOf();
    const drawing = new Drawing(context, mapView(width, height));
    if (track) {
      for (const side of [track.left, track.right]) drawing.line(pairs(side), { color: "muted" }, track.closed);
      drawing.line(pairs(track.driven), { color: "accent" });
    }
    drawing.points([poses[state.pose]], { shape: "dot", radius: 4.5, color: "accent" });
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

  const far = (point, event) => distance(point, [event.offsetX, event.offsetY]);
  const nearestOf = (points, event) => points.reduce((best, point, i) => (best >= 0 && far(points[best], event) <= far(point, event) ? best : i), -1);
  scene.addEventListener("pointermove", (event) => {
    const view = fit(scene.clientWidth, scene.clientHeight), { c, f, m = [] } = frame();
    const seen = c.length / 2, places = pairs([...c, ...m]), points = places.map(view.at);
    const nearest = nearestOf(points, event);
    tip.hidden = nearest < 0 || far(points[nearest], event) >= 12;
    if (tip.hidden) return;
    const kind = nearest >= seen ? "missed cone" : nearest < seen - f ? "cone" : "false positive";
    const [ahead, left] = places[nearest].map((value) => value / 100);
    tip.textContent = `${kind}, ${ahead.toFixed(2)} m ahead, ` +
      `${Math.abs(left).toFixed(2)} m ${left < 0 ? "right" : "left"}`;
    const [x, y] = points[nearest];
    tip.style.left = Math.max(4, Math.min(x + 10, scene.clientWidth - tip.offsetWidth - 4)) + "px";
    tip.style.top = Math.max(4, y - 28) + "px";
  });
  scene.addEventListener("pointerleave", () => { tip.hidden = true; });
  map.addEventListener("click", (event) => {
    go(nearestOf(mapOf().poses.map(mapView(map.clientWidth, map.clientHeight).at), event));
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
