// Files that the page plays: scenes and lanes of conelane, courses of EUFS and PacSim, runs of ft-fsd. docs/formats.md.

/** A file that is not what it should be: "NAME:LINE: KEY: REASON". */
export class FileError extends Error {}

const fail = (name, line, key, reason) => {
  throw new FileError([`${name}${line ? `:${line}` : ""}`, key, reason].filter(Boolean).join(": "));
};

const COLORS = ["unknown", "blue", "yellow", "orange"];
const kMax_m = 1e7;

function coordinate(value, name, line, key) {
  if (typeof value !== "number" || !Number.isFinite(value)) fail(name, line, key, "must be a finite number");
  if (Math.abs(value) > kMax_m) fail(name, line, key, "is beyond 10^7 m");
  return value;
}

function parsed(text, name, line) {
  try {
    return JSON.parse(text);
  } catch (error) {
    return fail(name, line, "", `is not JSON: ${error.message}`);
  }
}

function readScene(json, name, line) {
  const isObject = (value) => typeof value === "object" && value !== null;
  if (!isObject(json.pose)) fail(name, line, "pose", "missing");
  if (!Array.isArray(json.cones)) fail(name, line, "cones", "missing");
  const number = (value, key) => coordinate(value, name, line, key);
  const pose = { x: number(json.pose.x, "pose.x"), y: number(json.pose.y, "pose.y"), yaw: number(json.pose.yaw, "pose.yaw") };
  const ids = new Set();
  const cones = json.cones.map((cone, i) => {
    if (!isObject(cone)) fail(name, line, `cones[${i}]`, "must be an object");
    if (!Number.isSafeInteger(cone.id)) fail(name, line, `cones[${i}].id`, "must be a whole number");
    if (ids.has(cone.id)) fail(name, line, `cones[${i}].id`, "is there twice");
    ids.add(cone.id);
    const color = COLORS.find((one) => String(cone.color).endsWith(one)) ?? "unknown"; // big orange cones are orange ones here
    return { id: cone.id, x: number(cone.x, `cones[${i}].x`), y: number(cone.y, `cones[${i}].y`), color };
  });
  return { id: String(json.id ?? line), pose, cones, truth: json.ground_truth ?? null };
}

function readLane(json, name, line) {
  for (const side of ["left", "right"])
    if (!Array.isArray(json[side]) || !json[side].every(Number.isSafeInteger)) fail(name, line, side, "must be a list of cone ids");
  return json;
}

function readLines(text, name) {
  const scenes = [], lanes = [];
  text.split("\n").forEach((row, i) => {
    if (row.trim() === "") return;
    const json = parsed(row, name, i + 1);
    if (typeof json !== "object" || json === null) fail(name, i + 1, "", "must be an object");
    if (json.cones !== undefined || json.pose !== undefined) scenes.push(readScene(json, name, i + 1));
    else if (json.scene !== undefined && json.left !== undefined) lanes.push(readLane(json, name, i + 1));
    else fail(name, i + 1, "", "is neither a scene (pose, cones) nor a lane (scene, left, right)");
  });
  return scenes.length ? { kind: "scenes", name, scenes, lanes } : { kind: "lanes", name, lanes };
}

/** Two places at most this far apart are one cone in the next frame of a run. */
const SAME_CONE_M = 0.8;

function readRun(list, name) {
  const lists = ["unknown", "yellow", "blue", "orange", "orange"];
  let known = [], next = 1;
  const scenes = list.map((frame, at) => {
    const key = (text) => `[${at}].${text}`;
    const point = (value, text) => {
      if (!Array.isArray(value) || value.length !== 2) fail(name, 0, key(text), "must be [x, y]");
      return value.map((one, axis) => coordinate(one, name, 0, `${key(text)}[${axis}]`));
    };
    const [x, y] = point(frame?.car_position, "car_position"), [dx, dy] = point(frame.car_direction, "car_direction");
    if (!Array.isArray(frame.slam_cones) || frame.slam_cones.length !== lists.length)
      fail(name, 0, key("slam_cones"), "must hold five lists");
    const cones = [];
    const taken = new Set();
    frame.slam_cones.forEach((places, kind) => {
      if (!Array.isArray(places)) fail(name, 0, key(`slam_cones[${kind}]`), "must be a list");
      places.forEach((place, i) => {
        const [cx, cy] = point(place, `slam_cones[${kind}][${i}]`);
        let nearest = null, best = SAME_CONE_M;
        for (const one of known) {
          const distance = Math.hypot(one.x - cx, one.y - cy);
          if (distance <= best && !taken.has(one.id)) [nearest, best] = [one, distance];
        }
        const id = nearest ? nearest.id : next++;
        taken.add(id);
        cones.push({ id, x: cx, y: cy, color: lists[kind] });
      });
    });
    known = [...cones, ...known.filter((one) => !taken.has(one.id))];
    return { id: `frame ${at}`, pose: { x, y, yaw: Math.atan2(dy, dx) }, cones, truth: null };
  });
  if (scenes.length === 0) fail(name, 0, "", "holds no frame");
  return { kind: "scenes", name, scenes, lanes: [], ahead: true };
}

function readEufs(text, name) {
  const rows = text.split("\n");
  const columns = rows[0].split(",").map((one) => one.trim());
  const place = Object.fromEntries(["tag", "x", "y", "direction"].map((key) => {
    if (!columns.includes(key)) fail(name, 1, key, "column missing");
    return [key, columns.indexOf(key)];
  }));
  const cones = [];
  let start = null;
  rows.forEach((row, i) => {
    if (i === 0 || row.trim() === "") return;
    const fields = row.split(",").map((one) => one.trim());
    const number = (key) => {
      const text = fields[place[key]];
      if (text === undefined || text === "") fail(name, i + 1, key, "missing");
      return coordinate(Number.isNaN(Number(text)) ? text : Number(text), name, i + 1, key);
    };
    const tag = fields[place.tag];
    if (tag === "car_start") start = { x: number("x"), y: number("y"), yaw: number("direction") };
    else cones.push({ id: cones.length, x: number("x"), y: number("y"), color: COLORS.find((one) => tag.includes(one)) ?? "unknown" });
  });
  return { kind: "course", name, cones, start: start ?? startBetween(cones), closed: true };
}

/** Beside the first blue cone, between it and the yellow one nearest to it, along the boundary. */
function startBetween(cones) {
  const blue = cones.filter((cone) => cone.color === "blue"), yellow = cones.filter((cone) => cone.color === "yellow");
  if (!blue.length || !yellow.length) return { x: cones[0]?.x ?? 0, y: cones[0]?.y ?? 0, yaw: 0 };
  const [left] = blue;
  const right = yellow.reduce((a, b) => (Math.hypot(b.x - left.x, b.y - left.y) < Math.hypot(a.x - left.x, a.y - left.y) ? b : a));
  // The left cone is to the left of the car: its heading is across, from right to left, turned to the right.
  const yaw = Math.atan2(left.y - right.y, left.x - right.x) - Math.PI / 2;
  const x = (left.x + right.x) / 2, y = (left.y + right.y) / 2;
  return { x: x - Math.cos(yaw), y: y - Math.sin(yaw), yaw };
}

/** The subset of YAML that PacSim courses are written in. */
function readPacsim(text, name) {
  const cones = [];
  let section = "", closed = true, position = null, start = null;
  const numbers = (value, line, key) => {
    const list = /^\[(.*)\]$/.exec(value)?.[1].split(",").map((one) => (one.trim() === "" ? NaN : Number(one)));
    if (!list || list.length < 2 || list.length > 3) fail(name, line, key, "is not [x, y, z]");
    return list.map((one, i) => coordinate(one, name, line, `${key}[${i}]`));
  };
  text.split("\n").forEach((row, i) => {
    const found = /^(\s*)(-\s+)?([A-Za-z_]+):\s*(.*?)\s*(#.*)?$/.exec(row);
    if (!found) {
      if (row.replace(/#.*/, "").trim() && !/^\s*(---|\[\]|-\s*$)/.test(row)) fail(name, i + 1, "", "is not read: a key and its value are expected");
      return;
    }
    const [, , , key, value] = found;
    if (key === "lanesFirstWithLastConnected") closed = value === "true";
    else if (value === "" || value === "[]") section = key;
    else if (section === "start" && key === "position") start = { ...start, at: numbers(value, i + 1, key) };
    else if (section === "start" && key === "orientation") start = { ...start, turn: numbers(value, i + 1, key) };
    else if (["left", "right", "unknown"].includes(section) && key === "position") position = numbers(value, i + 1, `${section}.position`);
    else if (["left", "right", "unknown"].includes(section) && key === "class") {
      if (!position) fail(name, i + 1, `${section}.position`, "missing");
      cones.push({ id: cones.length, x: position[0], y: position[1], color: COLORS.find((one) => value.includes(one)) ?? "unknown", side: section });
      position = null;
    }
  });
  if (cones.length === 0) fail(name, 0, "track", "holds no cone");
  const pose = start?.at ? { x: start.at[0], y: start.at[1], yaw: start.turn?.[2] ?? 0 } : startBetween(cones);
  return { kind: "course", name, cones, start: pose, closed };
}

/** What a text holds: {kind: "scenes", scenes, lanes}, {kind: "lanes", lanes} or {kind: "course", cones, start, closed}. */
export function readText(text, name) {
  const begin = text.trimStart();
  if (begin.startsWith("{")) return readLines(text, name);
  if (begin.startsWith("[")) {
    const list = parsed(text, name, 0);
    return readRun(list, name);
  }
  if (/^\s*tag\s*,/.test(text) || /^[^\n]*,\s*tag\s*(,|\r?\n)/.test(text)) return readEufs(text, name);
  if (/^\s*track:/m.test(text)) return readPacsim(text, name);
  return fail(name, 0, "", "is not a scenes or lanes file, an EUFS or PacSim course or an ft-fsd run");
}

/** The same of bytes, which may be packed by gzip. */
export async function readBytes(bytes, name) {
  let stream = bytes;
  if (bytes[0] === 0x1f && bytes[1] === 0x8b) {
    const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    stream = new Uint8Array(await new Response(unpacked).arrayBuffer());
  }
  return readText(new TextDecoder().decode(stream), name);
}
