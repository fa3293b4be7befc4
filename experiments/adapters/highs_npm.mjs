// HiGHS compiled to WebAssembly, the npm package `highs`, as a solver from outside. `npm install highs` in a folder, then
//
//     conelane solve --solver "exec:highs-npm=node experiments/adapters/highs_npm.mjs FOLDER {lp} {sol} {limit_s} {gap} {seed}" ...
//
// One thread. The package reports no bound, and nothing at all if its time ends.
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";

const [folder, program, solution, limit, gap, seed] = process.argv.slice(2);
const require = createRequire(resolve(folder, "package.json"));
const version = JSON.parse(readFileSync(resolve(folder, "node_modules/highs/package.json"), "utf8")).version;
const highs = await require("highs")();
const begin = performance.now();
const result = highs.solve(readFileSync(program, "utf8"), {
  time_limit: Number(limit), mip_rel_gap: 0, mip_abs_gap: Math.max(Number(gap), 1e-9), random_seed: Number(seed) % 2147483647, threads: 1,
});
const lines = [`=ms= ${performance.now() - begin}`, `=solver= HiGHS of npm highs ${version}`];
if (result.Status === "Infeasible") {
  lines.push("=infeas=");
} else if (result.Status === "Optimal" || result.Status === "Time limit reached") {
  const named = Object.entries(result.Columns).filter(([, column]) => column.Primal);
  const has_point = Number.isFinite(result.ObjectiveValue) && named.length > 0;
  lines.push(`=status= ${result.Status === "Optimal" ? "optimal" : has_point ? "feasible" : "unknown"}`);
  if (has_point) lines.push(`=obj= ${result.ObjectiveValue}`, ...named.map(([name, column]) => `${name} ${column.Primal}`));
} else {
  console.error(result.Status);
  process.exit(1);
}
writeFileSync(solution, lines.join("\n") + "\n");
