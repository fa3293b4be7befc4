// example_test.mjs ROOT MODULE_DIR: the examples of docs/playground.md run, and print what the page says.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [root, module] = process.argv.slice(2);
if (!existsSync(`${module}/conelane.wasm`)) {
  console.log("skipped: the module was not built, since packages of [playground] in .ci/packages.txt are missing");
  process.exit(77);
}
const text = readFileSync(`${root}/docs/playground.md`, "utf8");
const [, source] = /^```js\n(.*?)^```$/ms.exec(text);
const [, printed] = /^It prints:\n\n```\n(.*?)^```$/ms.exec(text);
const folder = mkdtempSync(join(tmpdir(), "conelane-"));
try {
  for (const name of ["conelane.mjs", "conelane.wasm"]) copyFileSync(join(module, name), join(folder, name));
  writeFileSync(join(folder, "example.mjs"), source);
  assert.equal(execFileSync(process.execPath, [join(folder, "example.mjs")], { encoding: "utf8" }), printed);
  console.log("1 passed, 0 failed");
} finally {
  rmSync(folder, { recursive: true });
}

// The types name every call of the module, and no other.
const { load } = await import(join(module, "conelane.mjs"));
const conelane = await load();
const types = readFileSync(join(module, "conelane.d.ts"), "utf8");
const [, body] = /export interface Conelane \{(.*?)^\}/ms.exec(types);
const declared = [...body.matchAll(/^  (?:readonly )?(\w+)[(:]/gm)].map((found) => found[1]).sort();
const own = Object.keys(conelane).concat(Object.getOwnPropertyNames(Object.getPrototypeOf(conelane))).filter((name) => name !== "constructor").sort();
assert.deepEqual(declared, own);
