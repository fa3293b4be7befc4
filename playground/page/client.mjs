// A worker with the module, which starts again after an error or a search without end stopped it.

/** A call that has no answer after so long ends the worker. */
const PATIENCE_MS = 30_000;

export class Client {
  #make;
  #worker = null;
  #waiting = new Map();
  #next = 1;
  #ready = null;

  /** `make`: a new worker. `bytes`: of the module. `onRestart` gets the reason why a worker had to be started again. */
  constructor(make, bytes, onRestart) {
    this.#make = make;
    this.bytes = bytes;
    this.onRestart = onRestart;
  }

  /** The answer of the worker to a task of worker.mjs; rejects with its message. */
  async ask(task, given = {}) {
    if (!this.#worker) this.#start();
    await this.#ready;
    return this.#send(task, given);
  }

  /** What the module offers. */
  describe() {
    if (!this.#worker) this.#start();
    return this.#ready;
  }

  #start() {
    const worker = this.#make();
    worker.addEventListener("message", ({ data }) => this.#receive(data));
    worker.addEventListener("error", (event) => {
      event.preventDefault();
      if (worker === this.#worker) this.#end(event.message || "the worker stopped");
    });
    this.#worker = worker;
    this.#ready = this.#send("load", { bytes: this.bytes });
  }

  #send(task, given) {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => this.#end(`no answer after ${PATIENCE_MS / 1000} s`), PATIENCE_MS);
      this.#waiting.set(id, { resolve, reject, timer });
      this.#worker.postMessage({ id, task, ...given });
    });
  }

  #receive({ id, result, error, is_restarted }) {
    const waiting = this.#waiting.get(id);
    if (!waiting) return;
    this.#waiting.delete(id);
    clearTimeout(waiting.timer);
    if (error === undefined) {
      waiting.resolve(result);
      return;
    }
    if (is_restarted) this.onRestart?.(error);
    waiting.reject(new Error(error));
  }

  #end(reason) {
    this.#worker.terminate();
    this.#worker = null;
    const waiting = [...this.#waiting.values()];
    this.#waiting.clear();
    this.onRestart?.(reason);
    for (const { reject, timer } of waiting) {
      clearTimeout(timer);
      reject(new Error(reason));
    }
  }
}
