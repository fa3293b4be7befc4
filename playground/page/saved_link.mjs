// The link that holds the scene.
import { writeLink } from "./link.mjs";
import { $, attempt, METHODS, state } from "./state.mjs";

let saveTimer = 0;
export let ownHash = "";
export function saveSoon() {
  clearTimeout(saveTimer);
  saveTimer = setTimeout(save, 400);
}
export async function save() {
  clearTimeout(saveTimer);
  const methods = METHODS.map(({ name }) => name).filter((name) => state.methods[name]);
  ownHash = "#" + await writeLink({ world: state.world, car: state.car, sight: state.sight, methods });
  history.replaceState(null, "", ownHash);
}

$("copy-link").addEventListener("click", () => attempt(async () => {
  await save();
  try {
    await navigator.clipboard.writeText(location.href);
    $("copy-link").textContent = "Copied";
  } catch {
    $("copy-link").textContent = "It is in the address bar";
  }
  setTimeout(() => { $("copy-link").textContent = "Copy link"; }, 2000);
}));
