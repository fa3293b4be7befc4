// The library of conelane as a module: lanes between cones, in a browser, in a worker and in Node. See docs/playground.md and
// conelane.d.ts. Scenes and answers have the keys of the file formats, docs/formats.md.

const COLORS = ["unknown", "blue", "yellow", "orange", "big_orange"]; // in the order of ConeColor
const MISSIONS = ["trackdrive", "autocross", "acceleration", "skidpad"];
const encoder = new TextEncoder(), decoder = new TextDecoder();

/** An error of the library, with its message; or a module that stopped, which starts again with the next call. */
export class ConelaneError extends Error {
  constructor(message) {
    super(message);
    this.name = "ConelaneError";
  }
}

const refuse = (message) => { throw new ConelaneError(message); };

function finite(value, key) {
  if (typeof value !== "number" || !Number.isFinite(value)) refuse(`${key}: must be a finite number`);
  return value;
}

const isObject = (value) => typeof value === "object" && value !== null;

/** The numbers of a scene as exports.cpp reads them. `ids`: cones must have one; else those without it are NaN. */
function numbersOf(scene, ids) {
  if (!isObject(scene)) refuse("scene: must be an object");
  const { pose, cones } = scene;
  if (!isObject(pose)) refuse("pose: must be an object");
  if (!Array.isArray(cones)) refuse("cones: must be a list");
  const numbers = [finite(pose.x, "pose.x"), finite(pose.y, "pose.y"), finite(pose.yaw, "pose.yaw")];
  const seen = new Set();
  cones.forEach((cone, i) => {
    if (!isObject(cone)) refuse(`cones[${i}]: must be an object`);
    const missing = cone.id === undefined || cone.id === null;
    const id = missing ? (ids ? i : NaN) : cone.id;
    if (!Number.isNaN(id) || !missing) {
      if (!Number.isSafeInteger(id)) refuse(`cones[${i}].id: must be a whole number`);
      if (seen.has(id)) refuse(`cones[${i}].id: ${id} is there twice`);
      seen.add(id);
    }
    const color = COLORS.indexOf(cone.color ?? "unknown");
    if (color < 0) refuse(`cones[${i}].color: must be one of ${COLORS.join(", ")}`);
    const confidence = finite(cone.confidence ?? 1, `cones[${i}].confidence`);
    if (confidence < 0 || confidence > 1) refuse(`cones[${i}].confidence: must be in [0, 1]`);
    numbers.push(id, finite(cone.x, `cones[${i}].x`), finite(cone.y, `cones[${i}].y`), color, confidence);
  });
  return numbers;
}

function limitOf(options) {
  const limit = options.time_limit_ms ?? 50;
  if (typeof limit !== "number" || Number.isNaN(limit)) refuse("time_limit_ms: must be a number");
  return limit;
}

function idsOf(lane, side) {
  const ids = lane[side];
  if (!Array.isArray(ids) || !ids.every(Number.isSafeInteger)) refuse(`${side}: must be a list of cone ids`);
  return ids;
}

/** One instance of the module, which an error ends. */
class Instance {
  constructor(module) {
    let exports = null;
    const view = () => new DataView(exports.memory.buffer);
    const known = {
      clock_time_get: (clock, precision, at) => {
        view().setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
        return 0;
      },
      environ_sizes_get: (count, size) => {
        view().setUint32(count, 0, true);
        view().setUint32(size, 0, true);
        return 0;
      },
      environ_get: () => 0,
      proc_exit: (code) => refuse(`the module ended with code ${code}`),
    };
    const host = {
      thrown: (at) => {
        const bytes = new Uint8Array(exports.memory.buffer);
        refuse(decoder.decode(bytes.subarray(at, bytes.indexOf(0, at))));
      },
    };
    const imports = { wasi_snapshot_preview1: {}, conelane: host };
    for (const { module: from, name } of WebAssembly.Module.imports(module))
      if (from === "wasi_snapshot_preview1") imports[from][name] = known[name] ?? (() => 52); // 52: there is no such call
    exports = new WebAssembly.Instance(module, imports).exports;
    exports._initialize();
    this.exports = exports;
  }

  /** Calls an export. `lists` are given as pointer and count, a text as pointer and size; the answer is parsed. */
  call(name, given) {
    const { exports } = this;
    const words = given.map((one) => (typeof one === "string" ? encoder.encode(one) : one));
    let doubles = 0;
    const length = (one) => (one instanceof Uint8Array ? Math.ceil(one.length / 8) : Array.isArray(one) ? one.length : 0);
    for (const one of words) doubles += length(one);
    const room = exports.conelane_room(doubles);
    const values = [];
    let at = room;
    for (const one of words) {
      if (one instanceof Uint8Array) new Uint8Array(exports.memory.buffer, at, one.length).set(one);
      else if (Array.isArray(one)) new Float64Array(exports.memory.buffer, at, one.length).set(one);
      if (typeof one === "number") values.push(one);
      else values.push(at, one.length);
      at += 8 * length(one);
    }
    exports[name](...values);
  }

  answer() {
    const bytes = new Uint8Array(this.exports.memory.buffer, this.exports.conelane_text(), this.exports.conelane_text_size());
    return JSON.parse(decoder.decode(bytes));
  }
}

/** What went wrong, in words. */
function told(error) {
  if (error instanceof ConelaneError) return error;
  return new ConelaneError(`the module stopped: ${error.message}`);
}

class Conelane {
  #module;
  #instance;
  #restarts = 0;

  constructor(module) {
    this.#module = module;
    const { version, methods, parameters, courses } = this.#ask("conelane_describe", []);
    Object.assign(this, { version, methods, parameters, courses });
  }

  /** How many times an error ended an instance of the module. */
  get restarts() { return this.#restarts; }

  #ask(name, given) {
    this.#instance ??= new Instance(this.#module);
    try {
      this.#instance.call(name, given);
      return this.#instance.answer();
    } catch (error) {
      this.#instance = null;
      this.#restarts += 1;
      throw told(error);
    }
  }

  #parameterNumbers(given) {
    if (!isObject(given)) refuse("parameters: must be an object");
    const numbers = this.parameters.map((one) => {
      if (given[one.key] === undefined) return NaN;
      const value = finite(given[one.key], one.key);
      if (value < one.lowest || value > one.highest) refuse(`${one.key}: must be in [${one.lowest}, ${one.highest}]`);
      return value;
    });
    for (const key of Object.keys(given))
      if (!this.parameters.some((one) => one.key === key)) refuse(`${key}: is not a parameter`);
    return numbers;
  }

  #edgeNumbers(scene, edges) {
    if (!Array.isArray(edges)) refuse("edges: must be a list");
    const known = new Set(scene.cones.map((cone, i) => cone.id ?? i));
    return edges.flatMap((edge, i) => {
      if (!Array.isArray(edge) || edge.length !== 2 || edge[0] === edge[1]) refuse(`edges[${i}]: must be two cone ids`);
      for (const id of edge) if (!known.has(id)) refuse(`edges[${i}]: the scene has no cone ${id}`);
      return edge;
    });
  }

  detect(scene, options = {}) {
    const method = options.method ?? "front";
    if (!this.methods.some((one) => one.name === method))
      refuse(`method: there is no '${method}', only ${this.methods.map((one) => one.name).join(", ")}`);
    const nearest = options.nearest ?? -1;
    if (options.nearest !== undefined && !(Number.isSafeInteger(nearest) && nearest >= 1)) refuse("nearest: must be at least 1");
    const parameters = options.parameters ? this.#parameterNumbers(options.parameters) : [];
    return this.#ask("conelane_detect", [method, numbersOf(scene, true), parameters, nearest, limitOf(options)]);
  }

  centreLine(scene, lane, options = {}) {
    if (!isObject(lane)) refuse("lane: must be an object");
    const left = idsOf(lane, "left"), right = idsOf(lane, "right");
    const numbers = numbersOf(scene, true);
    const { step_m = 0.5, smoothing_m = 1.75, max_gap_m = 5.5, default_width_m = 3.5 } = options;
    const given = Object.entries({ step_m, smoothing_m, max_gap_m, default_width_m }).map(([key, value]) => finite(value, key));
    const closed = lane.closed === true ? 1 : 0;
    const line = this.#ask("conelane_centre_line", [numbers, [...left, ...right], left.length, closed, ...given]);
    if (lane.trusted_m !== undefined && lane.trusted_m !== null) line.trusted_m = Math.min(lane.trusted_m, line.length_m);
    return line;
  }

  solve(scene, options = {}) {
    const parameters = this.#parameterNumbers(options.parameters ?? {});
    return this.#ask("conelane_solve", [numbersOf(scene, true), parameters, limitOf(options)]);
  }

  #askOfEdges(name, scene, edges, options) {
    const parameters = this.#parameterNumbers(options.parameters ?? {});
    const numbers = numbersOf(scene, true);
    return this.#ask(name, [numbers, parameters, this.#edgeNumbers(scene, edges)]);
  }

  check(scene, edges, options = {}) { return this.#askOfEdges("conelane_check", scene, edges, options); }

  price(scene, edges, options = {}) { return this.#askOfEdges("conelane_price", scene, edges, options); }

  course(name, seed = 0, every_m = 1) {
    if (!this.courses.includes(name)) refuse(`course: there is no '${name}', only ${this.courses.join(", ")}`);
    if (!(Number.isSafeInteger(seed) && seed >= 0)) refuse("seed: must be a whole number, at least 0");
    return this.#ask("conelane_course", [name, seed, finite(every_m, "every_m")]);
  }

  planner(options = {}) {
    const mission = MISSIONS.indexOf(options.mission ?? "trackdrive");
    if (mission < 0) refuse(`mission: must be one of ${MISSIONS.join(", ")}`);
    const laps = options.laps ?? 0;
    if (options.laps !== undefined && !(Number.isSafeInteger(laps) && laps >= 1)) refuse("laps: must be at least 1");
    const method = options.method ?? "front-warm";
    if (!this.methods.some((one) => one.name === method)) refuse(`method: there is no '${method}'`);
    return new Planner(new Instance(this.#module), [mission, laps, method]);
  }

  /** Methods that carry a lane on forget it. */
  reset() { this.#instance?.exports.conelane_reset(); }
}

/** The planner of one run, in an instance of its own. */
class Planner {
  #instance;

  constructor(instance, given) {
    this.#instance = instance;
    instance.call("conelane_start_planner", given);
  }

  update(frame, options = {}) {
    if (!this.#instance) refuse("planner: an error ended it");
    const numbers = numbersOf(frame, false), time_s = finite(frame.time_s, "time_s");
    const limit = options.time_limit_ms ?? 50;
    try {
      this.#instance.call("conelane_plan", [time_s, numbers, limit]);
      return this.#instance.answer();
    } catch (error) {
      this.#instance = null;
      throw told(error);
    }
  }
}

async function moduleOf(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source === undefined || typeof source === "string" || source instanceof URL) {
    const url = new URL(source ?? "conelane.wasm", import.meta.url);
    if (url.protocol === "file:") {
      const { readFile } = await import("node:fs/promises");
      return WebAssembly.compile(await readFile(url));
    }
    const response = await fetch(url);
    if (!response.ok) refuse(`${url}: ${response.status}`);
    return WebAssembly.compile(await response.arrayBuffer());
  }
  return WebAssembly.compile(source);
}

/** The library. `source`: bytes, a compiled module or an address; `conelane.wasm` beside this file where it is absent. */
export async function load(source) {
  return new Conelane(await moduleOf(source));
}
