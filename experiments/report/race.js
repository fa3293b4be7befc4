"use strict";
// Plays one race: north up, metres, the view follows the car.
(() => {
  const source = document.getElementById("race-data");
  if (!source) return;
  const race = JSON.parse(source.textContent);
  const { marks, color, prepare, trace, positions, drawMark } = drawing;
  const element = (name) => document.getElementById("race-" + name);
  const canvas = element("scene"), slider = element("frame"), play = element("play");
  const reach_m = 25;
  let frame = 0, timer = null;
  slider.max = Math.max(0, race.frames.length - 1);

  const draw = () => {
    const now = race.frames[frame];
    if (!now) return;
    const { context, width, height } = prepare(canvas);
    const scale = Math.min(width, height) / (2 * reach_m);
    const x = (value) => width / 2 + (value - now.x) * scale;
    const y = (value) => height / 2 - (value - now.y) * scale;
    const placed = (flat) => positions(flat, { x, y: (_, north) => y(north) });
    const each = (flat, mark) => placed(flat).forEach((point) => drawMark(context, point, mark));
    const line = (points, name, thickness) => {
      context.strokeStyle = color(name);
      context.lineWidth = thickness;
      context.beginPath();
      trace(context, points, false);
      context.stroke();
    };
    for (const [side, name] of [[race.left, "m0"], [race.right, "m1"], [race.other, "muted"]]) each(side, { ...marks.cone, color: name });
    each(race.false_positives, marks.false);
    each(now.seen, { ...marks.missed, radius: 5 });
    line(race.frames.slice(0, frame + 1).map((past) => [x(past.x), y(past.y)]), "--muted", 1.5);
    line(placed(now.path), "--accent", 2.5);
    const corner = (ahead, left) => [x(now.x + ahead * Math.cos(now.yaw) - left * Math.sin(now.yaw)),
                                     y(now.y + ahead * Math.sin(now.yaw) + left * Math.cos(now.yaw))];
    line([corner(-0.6, 0.75), corner(2.2, 0.75), corner(2.2, -0.75), corner(-0.6, -0.75), corner(-0.6, 0.75)], "--ink", 1.5);
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
