// A car that drives by the paths of the planner: a bicycle, pure pursuit, a frame ten times a second.
import { look } from "./world.mjs";

export const FRAME_S = 0.1;
const STEP_S = 0.02;
const WHEELBASE_M = 1.55;
const MAX_STEERING_RAD = 0.55;
const MAX_STEERING_RATE = 2.0;
const MAX_LATERAL_MPS2 = 6;
const ACCELERATION_MPS2 = 4, BRAKING_MPS2 = 6;
const MAX_SPEED_MPS = 9;
/** Half the car, and half a cone. */
const HIT_M = 0.7;

export function startRun(world, car) {
  return {
    time_s: 0, car: { ...car }, speed: 0, steering: 0, path: [], plan: null, trail: [[car.x, car.y]], hit: new Set(),
    driven_m: 0, state: "driving", seen: null, latencies: [],
  };
}

/** The frame that the planner gets now. What is seen is kept in the run, to be drawn. */
export function frameOf(run, world, sight) {
  run.seen = look(world, run.car, { ...sight, exact: false });
  const cones = run.seen.cones.map(({ id, x, y }) => ({ id, x, y }));
  return { time_s: run.time_s, pose: { x: run.car.x, y: run.car.y, yaw: run.car.yaw }, cones };
}

function target(path, car, lookahead) {
  let from = 0, best = Infinity;
  path.forEach((point, i) => {
    const distance = Math.hypot(point.x - car.x, point.y - car.y);
    if (distance < best) [best, from] = [distance, i];
  });
  let i = from;
  while (i + 1 < path.length && Math.hypot(path[i].x - car.x, path[i].y - car.y) < lookahead) i += 1;
  return { point: path[i], from };
}

/** Drives to the next frame, by the plan. */
export function drive(run, plan, world) {
  run.plan = plan;
  run.latencies.push(plan.latency_ms);
  run.path = plan.lane.points;
  for (let t = 0; t < FRAME_S - 1e-9; t += STEP_S) step(run, plan, world);
  run.time_s += FRAME_S;
  run.trail.push([run.car.x, run.car.y]);
  if (plan.state === "finished" && run.speed < 0.05) run.state = "finished";
  else if (run.time_s > 3 && run.speed < 0.05) run.state = "stopped";
  return run.state;
}

function step(run, plan, world) {
  const { car, path } = run;
  let wanted = 0, steering = 0;
  if (path.length > 1) {
    const { point, from } = target(path, car, 2.5 + 0.35 * run.speed);
    const dx = point.x - car.x, dy = point.y - car.y;
    const left = -Math.sin(car.yaw) * dx + Math.cos(car.yaw) * dy, squared = dx * dx + dy * dy;
    if (squared > 1e-6) steering = Math.atan(WHEELBASE_M * 2 * left / squared);
    // As fast as the bends ahead and what is left of the path allow.
    const end = plan.stop ? path.at(-1).s_m : Math.min(path.at(-1).s_m, Math.max(plan.safe_m, 4) + 6);
    const room = Math.max(end - path[from].s_m - 1, 0);
    wanted = Math.min(MAX_SPEED_MPS, Math.sqrt(2 * BRAKING_MPS2 * 0.6 * room));
    for (const one of path.slice(from)) {
      const far = one.s_m - path[from].s_m;
      const bend = Math.sqrt(MAX_LATERAL_MPS2 / Math.max(Math.abs(one.curvature_1pm), 1e-3));
      wanted = Math.min(wanted, Math.sqrt(bend * bend + 2 * BRAKING_MPS2 * 0.5 * far));
    }
  }
  const change = MAX_STEERING_RATE * STEP_S, limited = Math.max(-MAX_STEERING_RAD, Math.min(MAX_STEERING_RAD, steering));
  run.steering += Math.max(-change, Math.min(change, limited - run.steering));
  run.speed += Math.max(-BRAKING_MPS2 * STEP_S, Math.min(ACCELERATION_MPS2 * STEP_S, wanted - run.speed));
  const turn = run.speed * Math.tan(run.steering) / WHEELBASE_M * STEP_S, yaw = car.yaw + turn / 2;
  car.x += run.speed * STEP_S * Math.cos(yaw);
  car.y += run.speed * STEP_S * Math.sin(yaw);
  car.yaw = Math.atan2(Math.sin(car.yaw + turn), Math.cos(car.yaw + turn));
  run.driven_m += run.speed * STEP_S;
  for (const cone of world.cones)
    if (!cone.is_false && Math.hypot(cone.x - car.x, cone.y - car.y) < HIT_M) run.hit.add(cone.id);
}
