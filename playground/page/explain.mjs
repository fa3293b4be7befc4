// Why the exact solver's lane is as it is: what a cone or an edge costs, or which constraint forbids it. What is compared are the
// lanes that differ from the answer in one place; the independent checker judges each.

const same = (a, b) => (a[0] === b[0] && a[1] === b[1]) || (a[0] === b[1] && a[1] === b[0]);
const without = (edges, gone) => edges.filter((edge) => !gone.some((one) => same(one, edge)));

/** Changes that are judged: those near the cone. */
const MAX_CHANGES = 40;

function graphOf(solution) {
  const neighbours = new Map();
  for (const [a, b] of solution.edges) {
    neighbours.set(a, [...(neighbours.get(a) ?? []), b]);
    neighbours.set(b, [...(neighbours.get(b) ?? []), a]);
  }
  return neighbours;
}

/** Judges the changes: {cost} of the cheapest that is a lane, else {violations} of the one that breaks least. */
function judge(conelane, scene, solution, changes) {
  let best = null;
  for (const { edges, words, note } of changes) {
    const check = conelane.check(scene, edges);
    const cost = check.objective === undefined ? Infinity : check.objective - solution.objective;
    const found = { words, note, edges, cost, violations: check.violations };
    const better = !best || found.violations.length < best.violations.length ||
      (found.violations.length === best.violations.length && cost < best.cost);
    if (better) best = found;
  }
  return best;
}

/** What edges cost, and their turns with each other. */
const prices = (conelane, scene, edges) => (({ edges: priced, turns }) => ({ priced, turns }))(conelane.price(scene, edges));

/** The cone, judged: {id, role, edges, turns, best}. `role`: left, right or none. */
export function explainCone(conelane, scene, solution, id) {
  const place = new Map(scene.cones.map((cone) => [cone.id, cone]));
  const neighbours = graphOf(solution);
  const mine = neighbours.get(id) ?? [];
  const role = solution.left.includes(id) ? "left" : solution.right.includes(id) ? "right" : "none";
  const { edges } = solution;
  const distance = (a) => Math.hypot(place.get(a).x - place.get(id).x, place.get(a).y - place.get(id).y);
  const changes = [];
  if (mine.length > 0) {
    const cut = without(edges, mine.map((one) => [id, one]));
    changes.push({ edges: mine.length === 2 ? [...cut, mine] : cut, words: "left out", note: mine.length === 2 ? mine : null });
    // Another cone in its place.
    const others = scene.cones.filter((cone) => !neighbours.has(cone.id)).sort((a, b) => distance(a.id) - distance(b.id));
    for (const other of others.slice(0, 8))
      changes.push({ edges: [...cut, ...mine.map((one) => [other.id, one])], words: `replaced by cone ${other.id}` });
  } else {
    for (const [a, b] of edges) changes.push({ edges: [...without(edges, [[a, b]]), [a, id], [id, b]], words: `put between ${a} and ${b}`, near: Math.min(distance(a), distance(b)) });
    for (const [end, [inner, more]] of neighbours) {
      if (more === undefined) {
        changes.push({ edges: [...edges, [end, id]], words: `put behind ${end}`, near: distance(end) });
        changes.push({ edges: [...without(edges, [[end, inner]]), [id, inner]], words: `put in place of ${end}`, near: distance(end) });
      } else {
        changes.push({ edges: [...without(edges, [[end, inner], [end, more]]), [id, inner], [id, more]], words: `put in place of ${end}`, near: distance(end) });
      }
    }
    changes.sort((a, b) => a.near - b.near);
  }
  const lines = mine.length ? prices(conelane, scene, mine.map((one) => [id, one])) : { priced: [], turns: [] };
  return { kind: "cone", id, role, ...lines, best: solution.edges.length ? judge(conelane, scene, solution, changes.slice(0, MAX_CHANGES)) : null };
}

/** The edge between two cones, in the same way. */
export function explainEdge(conelane, scene, solution, from, to) {
  const { edges } = solution;
  const neighbours = graphOf(solution);
  const isChosen = edges.some((edge) => same(edge, [from, to]));
  const { priced } = prices(conelane, scene, [[from, to]]);
  const changes = [];
  if (isChosen) changes.push({ edges: without(edges, [[from, to]]), words: "left out" });
  else {
    // What may have to go: an edge at either end.
    const options = (id) => [[], ...(neighbours.get(id) ?? []).map((one) => [[id, one]]), (neighbours.get(id) ?? []).map((one) => [id, one])];
    for (const a of options(from)) for (const b of options(to)) {
      const gone = [...a, ...b];
      const words = gone.length ? `chosen instead of ${gone.map(([x, y]) => `${x}–${y}`).join(", ")}` : "added";
      changes.push({ edges: [...without(edges, gone), [from, to]], words });
    }
  }
  const turns = isChosen
    ? prices(conelane, scene, [[from, to], ...[from, to].flatMap((id) => (neighbours.get(id) ?? []).filter((one) => one !== from && one !== to).map((one) => [id, one]))])
      .turns.filter((turn) => [[turn.from, turn.middle], [turn.middle, turn.to]].some((edge) => same(edge, [from, to])))
    : [];
  return { kind: "edge", from, to, is_chosen: isChosen, priced, turns, best: edges.length ? judge(conelane, scene, solution, changes) : null };
}
