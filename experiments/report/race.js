// Plays one race: north up, metres, the view follows the car.
(() => {
  const source = document.getElementById("race-data");
  if (!source) return;
  const race = JSON.parse(source.textContent);
  const element = (name) => document.getElementById("race-" + name);
  const canvas = element("scene"), slider = element("frame"), play = element("play");
  const reach_m = 25, car = { color: "ink", width: 1.5, outline: [[-0.6, 0.75], [2.2, 0.75], [2.2, -0.75], [-0.6, -0.75]] };
  const kinds = [[race.left, { ...marks.cone, color: "m0" }], [race.right, { ...marks.cone, color: "m1" }],
                 [race.other, { ...marks.cone, color: "muted" }], [race.false_positives, marks.false]];
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
    drawing.line(pairs(now.path), { color: "accent", width: 2.5 });
    drawing.body([now.x, now.y], now.yaw, car, scale);
    element("time").textContent = `${now.t.toFixed(1)} s${now.state ? ", " + now.state : ""}`;
    slider.value = frame;
  };
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
  slider.addEventListener("input", () => { stop(); frame = Number(slider.value); draw(); });
  addEventListener("resize", draw);
  document.addEventListener("themechange", draw);
  draw();
})();
