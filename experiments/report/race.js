"use strict";
// Plays one race: north up, metres, the view follows the car.
(() => {
  const source = document.getElementById("race-data");
  if (!source) return;
  const race = JSON.parse(source.textContent);
  const element = (name) => document.getElementById("race-" + name);
  const canvas = element("scene"), slider = element("frame"), play = element("play");
  const reach_m = 25;
  let frame = 0, timer = null;
  slider.max = Math.max(0, race.frames.length - 1);
  const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  const draw = () => {
    const now = race.frames[frame];
    if (!now) return;
    const ratio = devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = canvas;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const scale = Math.min(width, height) / (2 * reach_m);
    const x = (value) => width / 2 + (value - now.x) * scale;
    const y = (value) => height / 2 - (value - now.y) * scale;
    const each = (flat, mark) => {
      for (let i = 0; i + 1 < flat.length; i += 2) mark(x(flat[i]), y(flat[i + 1]));
    };
    const dots = (flat, radius, name) => {
      context.fillStyle = color(name);
      each(flat, (px, py) => { context.beginPath(); context.arc(px, py, radius, 0, 2 * Math.PI); context.fill(); });
    };
    const line = (points, name, thickness) => {
      context.strokeStyle = color(name);
      context.lineWidth = thickness;
      context.beginPath();
      points.forEach(([px, py], i) => (i ? context.lineTo(px, py) : context.moveTo(px, py)));
      context.stroke();
    };
    dots(race.left, 3, "--m0");
    dots(race.right, 3, "--m1");
    dots(race.other, 3, "--muted");
    context.strokeStyle = color("--muted");
    context.lineWidth = 1;
    each(race.false_positives, (px, py) => {
      context.beginPath();
      context.moveTo(px - 3, py - 3); context.lineTo(px + 3, py + 3);
      context.moveTo(px - 3, py + 3); context.lineTo(px + 3, py - 3);
      context.stroke();
    });
    context.strokeStyle = color("--ink");
    each(now.seen, (px, py) => { context.beginPath(); context.arc(px, py, 5, 0, 2 * Math.PI); context.stroke(); });
    line(race.frames.slice(0, frame + 1).map((past) => [x(past.x), y(past.y)]), "--muted", 1.5);
    const path = [];
    each(now.path, (px, py) => path.push([px, py]));
    if (path.length) line(path, "--accent", 2.5);
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
