// A world, the car and what is set, as the text behind # of an address.

const VERSION = "1.";

async function through(bytes, transform) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(transform)).arrayBuffer());
}

const toText = (bytes) => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""))
  .replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const toBytes = (text) => Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));

const CONE_COLORS = ["unknown", "blue", "yellow", "orange"];
const cm = (value) => Math.round(value * 100);

/** Places are kept to the centimetre. */
export async function writeLink({ world, car, sight, methods }) {
  const told = {
    n: world.name, l: world.label, c: world.closed ? 1 : 0,
    s: [cm(world.start.x), cm(world.start.y), world.start.yaw],
    p: [cm(car.x), cm(car.y), Math.round(car.yaw * 1e4) / 1e4],
    k: world.cones.flatMap((cone) => [cone.id, cm(cone.x), cm(cone.y), CONE_COLORS.indexOf(cone.color ?? "unknown") + (cone.is_false ? 4 : 0)]),
    g: [...world.gone], o: sight, m: methods,
  };
  const packed = await through(new TextEncoder().encode(JSON.stringify(told)), new CompressionStream("deflate-raw"));
  return VERSION + toText(packed);
}

/** Throws where the text is no such link. `line` of the world is left to whoever knows the course of that name. */
export async function readLink(text) {
  if (!text.startsWith(VERSION)) throw new Error("this link is of another version of the playground");
  let told;
  try {
    told = JSON.parse(new TextDecoder().decode(await through(toBytes(text.slice(VERSION.length)), new DecompressionStream("deflate-raw"))));
  } catch {
    throw new Error("this link is broken: it was cut off or changed on its way");
  }
  const pose = ([x, y, yaw]) => ({ x: x / 100, y: y / 100, yaw });
  const cones = [];
  for (let i = 0; i + 3 < told.k.length; i += 4) {
    const [id, x, y, kind] = told.k.slice(i, i + 4);
    cones.push({ id, x: x / 100, y: y / 100, color: CONE_COLORS[kind % 4], ...(kind >= 4 && { is_false: true }) });
  }
  const world = { name: told.n, label: told.l, closed: told.c === 1, cones, line: null, gone: new Set(told.g), start: pose(told.s) };
  return { world, car: pose(told.p), sight: told.o, methods: told.m };
}
