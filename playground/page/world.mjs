// What stands on the ground, and what the car sees of it.

/** Ids of false positives are from here on; those of cones are below. */
export const FALSE_IDS = 1_000_000_000;
/** Ids of false cones are long numbers, which say nothing. */
export const coneName = (id) => (id >= FALSE_IDS ? `F${(id - FALSE_IDS).toString(36).toUpperCase()}` : String(id));
/** False positives are drawn one in each square of this side. */
const CELL_M = 1.5;

/** A number in [0, 1) that depends on whole numbers alone. */
export function drawn(...numbers) {
  let hash = 0x9e3779b9;
  for (const number of numbers) {
    hash = Math.imul(hash ^ (number | 0), 0x85ebca6b);
    hash = Math.imul(hash ^ (hash >>> 13), 0xc2b2ae35);
    hash ^= hash >>> 16;
  }
  return (hash >>> 0) / 4294967296;
}

/** Standard normal, from two of the same. */
function gaussian(...numbers) {
  const radius = Math.sqrt(-2 * Math.log(1 - drawn(...numbers, 1)));
  return radius * Math.cos(2 * Math.PI * drawn(...numbers, 2));
}

export const DEFAULT_SIGHT = { rate: 0.3, noise_m: 0.05, missed: 0.05, range_m: 30, seed: 1, exact: false };

/** An id that no cone has. */
export function newId(world) {
  return world.cones.reduce((largest, cone) => Math.max(largest, cone.id), 0) + 1;
}

/** Whether a place is in the half disc ahead of the car. */
export function inView(car, range_m, x, y) {
  const dx = x - car.x, dy = y - car.y;
  return dx * dx + dy * dy <= range_m * range_m && dx * Math.cos(car.yaw) + dy * Math.sin(car.yaw) >= 0;
}

/** Candidates for false positives in view, the first to be seen first. They keep their places while the car drives. */
function falseCandidates(car, range_m, seed) {
  const found = [];
  const cells = (value) => Math.floor(value / CELL_M);
  for (let i = cells(car.x - range_m); i <= cells(car.x + range_m); i++) {
    for (let j = cells(car.y - range_m); j <= cells(car.y + range_m); j++) {
      const x = (i + drawn(seed, i, j, 3)) * CELL_M, y = (j + drawn(seed, i, j, 4)) * CELL_M;
      if (!inView(car, range_m, x, y)) continue;
      // An id of the place, the same whatever else is in view.
      const id = FALSE_IDS + ((i & 0xffff) * 0x10000 + (j & 0xffff));
      found.push({ id, x, y, order: drawn(seed, i, j, 5) });
    }
  }
  return found.sort((a, b) => a.order - b.order || a.id - b.id);
}

/**
 * What the car sees: `cones` (with `truth`, the cone of the world, and `is_false`), and the cones in view that it missed.
 * `sight.rate` is the share of false ones among all seen. With `sight.exact` everything on the ground is seen as it is.
 */
export function look(world, car, sight) {
  const seen = [], missed = [];
  for (const cone of world.cones) {
    if (sight.exact) {
      seen.push({ id: cone.id, x: cone.x, y: cone.y, is_false: false });
      continue;
    }
    if (!inView(car, sight.range_m, cone.x, cone.y)) continue;
    if (drawn(sight.seed, cone.id, 6) < sight.missed) {
      missed.push(cone);
      continue;
    }
    const dx = sight.noise_m * gaussian(sight.seed, cone.id, 7), dy = sight.noise_m * gaussian(sight.seed, cone.id, 8);
    seen.push({ id: cone.id, x: cone.x + dx, y: cone.y + dy, is_false: Boolean(cone.is_false) });
  }
  if (!sight.exact && sight.rate > 0) {
    let wanted = Math.round(seen.length * sight.rate / (1 - sight.rate));
    for (const { id, x, y } of falseCandidates(car, sight.range_m, sight.seed)) {
      if (wanted <= 0) break;
      if (world.gone.has(id)) continue;
      seen.push({ id, x, y, is_false: true });
      wanted -= 1;
    }
  }
  return { cones: seen, missed };
}

/** The scene that a method gets. */
export function sceneOf(car, seen) {
  return { pose: { x: car.x, y: car.y, yaw: car.yaw }, cones: seen.map(({ id, x, y }) => ({ id, x, y })) };
}

/** A world of a generated course. */
export function worldOfCourse(course, label) {
  const [x, y, yaw] = course.line[0];
  return {
    name: course.name, label: label ?? course.name, closed: course.closed,
    cones: course.cones.map(({ id, x, y, color }) => ({ id, x, y, color })),
    line: course.line, gone: new Set(), start: { x, y, yaw },
  };
}

/** A world of cones alone. */
export function worldOfCones(name, cones, start, closed = false) {
  return { name, label: name, closed, cones, line: null, gone: new Set(), start };
}
