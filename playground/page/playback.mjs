// Drives a lap, or plays a file.
import { drive, FRAME_S, frameOf, startRun } from "./drive.mjs";
import { $, attempt, clients, median, ms, on, state } from "./state.mjs";
import { changed, whenSettled } from "./detect_loop.mjs";
import { fitView, follow } from "./picture.mjs";
import { showScene } from "./worlds.mjs";

const speed = () => Number($("speed").value);
const isFile = () => state.file && state.file.scenes.length > 1;

function tellPlaybar() {
  $("frame").hidden = !isFile();
  if (isFile()) {
    $("frame").max = state.file.scenes.length - 1;
    $("frame").value = state.file.at;
  }
  $("play").textContent = state.playing ? "Pause" : isFile() ? "▶ Play" : state.run && state.run.state === "driving" ? "▶ Go on" : "▶ Drive a lap";
  document.body.dataset.playing = String(state.playing);
  tellRun();
}

on("world", tellPlaybar);

function tellRun() {
  const { run } = state;
  let text = "";
  if (run) {
    const plan = run.plan;
    const end = { finished: `lap finished: ${run.driven_m.toFixed(0)} m in ${run.time_s.toFixed(1)} s`, stopped: "the car stopped", left: "the car left the lane" }[run.state];
    const hit = run.hit.size ? `, ${run.hit.size} ${run.hit.size === 1 ? "cone" : "cones"} hit` : end ? ", no cone hit" : "";
    text = end ? `${end}${hit}` : `${plan?.state ?? "searching"} · ${(run.speed * 3.6).toFixed(0)} km/h · ${run.driven_m.toFixed(0)} m${hit}`;
    if (run.latencies.length > 5) text += ` · plan ${ms(median(run.latencies))}`;
    document.body.dataset.run = run.state;
  } else {
    delete document.body.dataset.run;
    if (state.file) text = `${state.file.at + 1} of ${state.file.scenes.length}: ${state.world?.name ?? ""}${state.file_lanes.length ? ` · stored lane of ${state.file_lanes.map((lane) => lane.method ?? "?").join(", ")}` : ""}`;
  }
  $("run-state").textContent = text;
}

function stopRun() {
  state.playing = false;
  state.run = null;
}

const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

async function playFile() {
  while (state.playing && state.file && state.file.at + 1 < state.file.scenes.length) {
    const begun = performance.now();
    showScene(state.file.at + 1);
    await Promise.race([whenSettled(), pause(1000)]);
    await pause(Math.max(100 / speed() - (performance.now() - begun), 4));
  }
  state.playing = false;
  tellPlaybar();
}

function nearestOnLine(world, car) {
  return world.line.reduce((best, [x, y], i) => {
    const distance = Math.hypot(x - car.x, y - car.y);
    return distance < best.distance ? { distance, i } : best;
  }, { distance: Infinity, i: 0 });
}

async function driveLap() {
  if (!state.run || state.run.state !== "driving") {
    state.run = startRun(state.world, state.car);
    await clients.first.ask("start", { laps: 1 });
    follow(state.run.car, true);
  }
  const { run, world } = state;
  while (state.playing && state.run === run && run.state === "driving") {
    const begun = performance.now();
    const plan = await clients.first.ask("plan", { frame: frameOf(run, world, state.sight), time_limit_ms: 50 });
    if (state.run !== run) return;
    const before = { ...run.car };
    drive(run, plan, world);
    const after = { ...run.car };
    if (world.line && nearestOnLine(world, after).distance > 4) run.state = "left";
    changed();
    tellRun();
    // The picture goes smoothly from frame to frame.
    const lasts = FRAME_S * 1000 / speed();
    for (;;) {
      const share = Math.min((performance.now() - begun) / lasts, 1);
      const turn = Math.atan2(Math.sin(after.yaw - before.yaw), Math.cos(after.yaw - before.yaw));
      run.car = { x: before.x + share * (after.x - before.x), y: before.y + share * (after.y - before.y), yaw: before.yaw + share * turn };
      follow(run.car);
      changed("picture");
      if (share >= 1) break;
      await new Promise(requestAnimationFrame);
    }
    run.car = after;
  }
  if (state.run === run && run.state !== "driving") state.playing = false;
  tellPlaybar();
}

export function togglePlay() {
  state.playing = !state.playing;
  tellPlaybar();
  if (!state.playing) return;
  attempt(async () => {
    if (isFile()) {
      if (state.file.at + 1 >= state.file.scenes.length) showScene(0);
      state.playing = true;
      tellPlaybar();
      await playFile();
    } else {
      try {
        await driveLap();
      } catch (error) {
        stopRun();
        changed();
        tellPlaybar();
        throw error;
      }
    }
  });
}
$("play").addEventListener("click", togglePlay);
$("back").addEventListener("click", () => {
  if (isFile()) showScene(0);
  else {
    stopRun();
    state.car = { ...state.world.start };
    fitView();
    changed();
  }
  tellPlaybar();
});
$("frame").addEventListener("input", (event) => {
  state.playing = false;
  showScene(Number(event.target.value));
});
