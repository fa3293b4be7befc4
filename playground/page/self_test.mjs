// The module's lanes against those that the native program stored (stored_scenes.json).

/** Calls of front for each scene. */
const CALLS = 15;

const sameLane = (a, b) => a.status === b.status && a.closed === b.closed &&
  String(a.left) === String(b.left) && String(a.right) === String(b.right);

/** {failed: words for each lane that differs, lanes: how many were compared, median_ms: of front}. */
export function selfTest(conelane, stored) {
  const failed = [], times = [];
  let lanes = 0;
  for (const { scene, answers } of stored) {
    for (const native of answers) {
      const answer = conelane.detect(scene, { method: native.method, time_limit_ms: Infinity });
      lanes += 1;
      if (!sameLane(answer, native)) failed.push(`${scene.id}, ${native.method}: another lane`);
    }
    for (let i = 0; i < CALLS; i++) times.push(conelane.detect(scene, { method: "front", time_limit_ms: Infinity }).latency_ms);
  }
  times.sort((a, b) => a - b);
  return { failed, lanes, scenes: stored.length, median_ms: times[Math.floor(times.length / 2)] };
}
