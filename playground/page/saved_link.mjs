// The link that holds the scene.
import { METHODS } from "./draw.mjs";
import { readLink, writeLink } from "./link.mjs";
import { $, attempt, state } from "./state.mjs";
import { turn } from "./method_cards.mjs";
import { restoreLine, setWorld } from "./worlds.mjs";

let saveTimer = 0, ownHash = "";
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

export async function openLink(hash) {
  const { world, car, sight, methods } = await readLink(hash.slice(1));
  state.file = null;
  for (const { name } of METHODS) if (state.methods[name] !== methods.includes(name)) turn(name, methods.includes(name));
  $("course").value = "";
  $("another").hidden = true;
  setWorld(world, { car, sight });
  await restoreLine();
}
addEventListener("hashchange", () => { if (location.hash !== ownHash && location.hash) attempt(() => openLink(location.hash)); });

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
