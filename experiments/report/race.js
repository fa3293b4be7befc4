// Plays one race, or a run that was recorded: north up, metres, the view follows the car.
(() => {
  const source = document.getElementById("race-data");
  if (!source) return;
  const race = JSON.parse(source.textContent);
  const element = (name) => document.getElementById("race-" + name);
  const canvas = element("scene"), slider = element("frame"), play = element("play");
  const reach_m = 25, car = { color: "ink", width: 1.5, outline: [[-0.6, 0.75], [2.2, 0.75], [2.2, -0.75], [-0.6, -0.75]] };
  const kinds = [[race.left, { ...marks.cone, color: "m0" }], [race.right, { ...marks.cone, color: "m1" }],
                 [race.other, { ...marks.cone, color: "muted" }], [race.false_positives, marks.false]];
  const side = (color) => ({ ...marks.lane, color }), untrusted = { width: 1 };
  const strip = element("states"), most_m = 20; // of a recorded run: the trusted length of each frame
  const stateColors = { following: "m1", bridging: "m3", searching: "muted", lost: "accent", finished: "m0" };
  let frame = 0, timer = null;
  slider.max = Math.max(0, race.frames.length - 1);

  const draw = () => {
    const now = race.frames[frame];
    if (!now) return;
    const { context, width, height } = sized(canvas), scale = Math.min(width, height) / (2 * reach_m);
    const drawing = new Drawing(context, { scale, at: ([x, y]) => [width / 2 + (x - now.x) * scale, height / 2 - (y - now.y) * scale] });
    for (const [places, mark] of kinds) drawing.points(pairs(places), mark);
    drawing.points(pairs(now.seen), { ...marks.missed, radius: 5 });
    drawing.line(race.frames.slice(0, frame + 1).map((past) => [past.x, past.y]), { color: "muted", width: 1.5 });
    for (const name of ["left", "right"]) {
      const points = pairs(now[name] ?? []), trusted = now.trusted ?? 0;
      drawing.line(points.slice(0, trusted), side(name));
      drawing.line(points.slice(Math.max(0, trusted - 1)), { ...side(name), ...untrusted });
    }
    drawing.line(pairs(now.path), { color: "accent", width: 2.5 });
    drawing.body([now.x, now.y], now.yaw, car, scale);
    element("time").textContent = [`${now.t.toFixed(1)} s`, now.state, now.says].filter(Boolean).join(", ");
    slider.value = frame;
    drawStates();
  };
  const drawStates = () => {
    if (!strip) return;
    const { context, width, height } = sized(strip), drawing = new Drawing(context, { scale: 1, at: (point) => point });
    const across = (i) => (i + 0.5) * width / race.frames.length;
    for (const [state, color] of Object.entries(stateColors)) {
      drawing.paint({ color, width: Math.max(1, width / race.frames.length) }, () => race.frames.forEach((one, i) => {
        if (one.state !== state) return;
        context.moveTo(across(i), height);
        context.lineTo(across(i), height - 3 - (height - 3) * Math.min(1, one.safe / most_m));
      }));
    }
    drawing.line([[across(frame), 0], [across(frame), height]], { color: "ink", width: 1.5 });
  };
  const go = (to) => { stop(); frame = Math.max(0, Math.min(race.frames.length - 1, to)); draw(); };
  const stop = () => { clearInterval(timer); timer = null; play.textContent = "▶"; };
  play.addEventListener("click", () => {
    if (timer) { stop(); return; }
    if (frame + 1 >= race.frames.length) frame = 0;
    play.textContent = "❚❚";
    timer = setInterval(() => {
      if (frame + 1 >= race.frames.length) { stop(); return; }
      frame += 1;
      draw();
    }, 100);
  });
  slider.addEventListener("input", () => go(Number(slider.value)));
  strip?.addEventListener("click", (event) => go(Math.floor(event.offsetX / strip.clientWidth * race.frames.length)));
  for (const button of document.querySelectorAll("[data-frame]")) {
    button.addEventListener("click", () => { go(Number(button.dataset.frame)); strip.scrollIntoView(); });
  }
  addEventListener("resize", draw);
  document.addEventListener("themechange", draw);
  draw();
})();
