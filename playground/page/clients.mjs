// The module, twice, each in a worker.
import { $ } from "./state.mjs";

export async function moduleBytes() {
  const packed = Uint8Array.from(atob($("module-bytes").textContent.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

const workerUrl = URL.createObjectURL(new Blob([$("worker-text").textContent], { type: "text/javascript" }));
export const makeWorker = () => new Worker(workerUrl);
/** `first` finds lanes and plans; `second` tests itself and explains, which may take longer. */
export const clients = { first: null, second: null };
