// Begins: the module, the first course, the self-test.
import { Client } from "./client.mjs";
import { $, clients, ms, onRestart, showError, state, view } from "./state.mjs";
import { changed, times, whenSettled } from "./detect_loop.mjs";
import { save } from "./saved_link.mjs";
import { darkness, setTheme } from "./picture.mjs";
import { select } from "./changes.mjs";
import { makeMethods, turn } from "./method_cards.mjs";
import { LIMITS_MS, tellSliders } from "./sight_controls.mjs";
import { chooseCourse, FIRST_COURSE, makeCourses, openFiles, openLink } from "./worlds.mjs";
import {} from "./playback.mjs";
import {} from "./pointer.mjs";
import {} from "./keys.mjs";

const workerUrl = URL.createObjectURL(new Blob([$("worker-text").textContent], { type: "text/javascript" }));
const makeWorker = () => new Worker(workerUrl);

async function moduleBytes() {
  const packed = Uint8Array.from(atob($("module-bytes").textContent.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

async function runSelfTest() {
  const stored = JSON.parse($("stored-scenes").textContent);
  try {
    const { failed, lanes, scenes, median_ms } = await clients.second.ask("selfTest", { stored });
    document.body.dataset.medianMs = median_ms.toFixed(3);
    document.body.dataset.selfTest = failed.length ? `failed: ${failed.join("; ")}` : "passed";
    $("self-test").textContent = failed.length
      ? `The self-test failed: ${failed.length} of ${lanes} lanes are not those of the native program (${failed[0]}).`
      : `Self-test passed: ${lanes} lanes of ${scenes} scenes are those of the native program. front takes ${ms(median_ms)} here, in the median.`;
  } catch (error) {
    document.body.dataset.selfTest = `failed: ${error.message}`;
    $("self-test").textContent = `The self-test failed: ${error.message}`;
  }
}

async function begin() {
  setTheme(darkness.matches ? "dark" : "light");
  const bytes = await moduleBytes();
  clients.first = new Client(makeWorker, bytes, onRestart);
  clients.second = new Client(makeWorker, bytes, onRestart);
  const { version: number, courses } = await clients.first.describe();
  $("version").textContent = number;
  makeMethods();
  makeCourses(courses);
  $("limit").value = LIMITS_MS.indexOf(state.limit_ms);
  tellSliders();
  const first = courses.includes(FIRST_COURSE) ? FIRST_COURSE : courses[0];
  if (location.hash.length > 1) {
    try {
      await openLink(location.hash);
    } catch (error) {
      showError(error.message);
      await chooseCourse(first);
    }
  } else await chooseCourse(first);
  await whenSettled();
  document.body.dataset.ready = "true";
  for (const name of Object.keys(times)) times[name] = [];
  changed(); // once more, by a module that is warm
  await runSelfTest();
}

/** For tests and the console. */
globalThis.playground = {
  state, view, whenSettled, select, turn, openFiles, save,
  ask: (task, given) => clients.first.ask(task, given),
  place: (id) => { const cone = state.seen.find((one) => one.id === id); return cone && view.at([cone.x, cone.y]); },
};

begin().catch((error) => {
  document.body.dataset.selfTest = `failed: ${error.message}`;
  showError(`The page could not start: ${error.message}. It takes a browser of 2023 or newer.`);
});
