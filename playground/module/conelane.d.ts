/** The library of conelane in WebAssembly. Lengths in metres, angles in radians (counter-clockwise, 0 along +x), times in
 * milliseconds. Scenes and answers have the keys of the file formats, docs/formats.md. */

export type Color = "unknown" | "blue" | "yellow" | "orange" | "big_orange";
export type Mission = "trackdrive" | "autocross" | "acceleration" | "skidpad";
export type StopReason = "time" | "iterations" | "memory";

export interface Pose { x: number; y: number; yaw: number }

export interface Cone {
  /** A whole number, distinct in the scene. Where it is absent, the place in the list. */
  id?: number;
  x: number;
  y: number;
  /** `unknown` where absent. */
  color?: Color;
  /** In [0, 1]; 1 where absent. */
  confidence?: number;
}

/** All that a method may know. More keys, such as those of a scenes file, are ignored. */
export interface Scene { pose: Pose; cones: readonly Cone[] }

/** Both boundaries as cone ids in driving order, from the car outward. */
export interface Lane { left: number[]; right: number[]; closed: boolean }

export interface Answer extends Lane {
  method: string;
  /** `none`: there is no feasible lane. `stopped`: none was found before a limit. `left` and `right` are empty unless `found`. */
  status: "found" | "none" | "stopped" | "error";
  message?: string;
  /** The limit that ended the search. */
  stopped_by?: StopReason;
  /** Probability that the lane is usable, of methods that know it. */
  confidence?: number;
  /** Distance up to which the lane can be trusted. */
  trusted_m?: number;
  /** Of methods that optimise: objective, proven lower bound, and whether both meet. */
  objective?: number;
  bound?: number;
  optimal?: boolean;
  /** Of methods that enumerate. */
  iterations?: number;
  complete?: boolean;
  /** Cones within 0.12 m of another one (front: up to 0.35 m if many are doubled), each with the id that represents both. */
  merged: [number, number][];
  /** From the scene in the module's memory to the lane. */
  latency_ms: number;
}

export interface CentreLinePoint {
  s_m: number;
  x: number;
  y: number;
  heading_rad: number;
  curvature_1pm: number;
  width_left_m: number;
  width_right_m: number;
}

export interface CentreLine {
  /** Empty if the lane has no extent. */
  points: CentreLinePoint[];
  closed: boolean;
  length_m: number;
  trusted_m?: number;
  /** No cone of that boundary is known: it is taken to be `default_width_m` from the other one. */
  left_inferred: boolean;
  right_inferred: boolean;
}

export interface Solution extends Lane {
  status: "optimal" | "feasible" | "infeasible" | "stopped" | "error";
  message?: string;
  stopped_by?: StopReason;
  /** The lane graph, as pairs of cone ids. */
  edges: [number, number][];
  objective?: number;
  bound?: number;
  nodes: number;
  /** Number of edges that constraint (27) allows. */
  candidate_edges: number;
  total_ms: number;
}

export interface Check {
  /** A sentence for each violated constraint; none: the edges are a lane graph. */
  violations: string[];
  objective?: number;
  /** Added edges cannot repair a violation. */
  is_final: boolean;
}

export interface EdgePrice {
  from: number;
  to: number;
  /** s (18) and p (25), without weight. */
  spacing_cost: number;
  heading_cost: number;
  /** With weights, less the benefit of an edge (29). */
  cost: number;
  along_heading: boolean;
  /** Forbidden by (27). */
  high_cost: boolean;
}

export interface TurnPrice {
  from: number;
  middle: number;
  to: number;
  /** t (20), without weight. */
  angle_cost: number;
  cost: number;
  /** Forbidden by (28). */
  high_cost: boolean;
}

export interface Prices { edges: EdgePrice[]; turns: TurnPrice[] }

/** Keys of docs/formats.md, "RLD parameters"; absent ones have their default. */
export type Parameters = Record<string, number>;

export interface DetectOptions {
  /** A name of `methods`; `front` where absent. */
  method?: string;
  /** 50 where absent; `Infinity` for none. */
  time_limit_ms?: number;
  /** Number of cones to answer for: the nearest ahead. */
  nearest?: number;
  /** Of the rld- methods. */
  parameters?: Parameters;
}

export interface CentreLineOptions { step_m?: number; smoothing_m?: number; max_gap_m?: number; default_width_m?: number }
export interface SolveOptions { parameters?: Parameters; time_limit_ms?: number }

export interface Frame extends Scene { time_s: number }

export interface Plan {
  state: "searching" | "following" | "bridging" | "lost" | "finished";
  /** The path to drive, from the car on. */
  lane: CentreLine;
  safe_m: number;
  age_s: number;
  lap: number;
  /** Come to rest within the rest of `lane`. */
  stop: boolean;
  /** Distance along `lane` to the line past which the car has to stop; absent while it is not on the lane. */
  stop_line_m?: number;
  /** Why the course of the lap before is not trusted to its end, or why the path is lost; else empty. */
  reason: string;
  phase: string;
  answer: Omit<Answer, "method" | "merged" | "latency_ms">;
  latency_ms: number;
}

/** Drives one run. An error ends it. */
export interface Planner {
  update(frame: Frame, options?: { time_limit_ms?: number }): Plan;
}

/** A generated course. */
export interface Course {
  name: string;
  closed: boolean;
  cones: (Cone & { id: number })[];
  /** Places in `cones`, in driving order. */
  left: number[];
  right: number[];
  /** Poses of the centre line: x, y, yaw. */
  line: [number, number, number][];
}

/** Its calls throw a `ConelaneError` for invalid input. */
export interface Conelane {
  readonly version: string;
  readonly methods: { name: string; description: string }[];
  readonly parameters: {
    key: string; unit: string; default: number; lowest: number; highest: number; description: string;
  }[];
  /** Names that `course` takes. */
  readonly courses: string[];
  /** How many times an error ended the module; it starts again with the next call. */
  readonly restarts: number;

  /** The lane of a scene. Methods whose name ends by -warm keep the lane of the last scene until `reset`. */
  detect(scene: Scene, options?: DetectOptions): Answer;
  /** The line to drive along, from the car on. */
  centreLine(scene: Scene, lane: Lane & { trusted_m?: number }, options?: CentreLineOptions): CentreLine;
  /** The exact solver: the lane graph of least cost, with a proof. */
  solve(scene: Scene, options?: SolveOptions): Solution;
  /** The verdict of the independent checker on a set of edges. */
  check(scene: Scene, edges: readonly [number, number][], options?: { parameters?: Parameters }): Check;
  /** The costs of edges and of their turns with each other. */
  price(scene: Scene, edges: readonly [number, number][], options?: { parameters?: Parameters }): Prices;
  course(name: string, seed?: number, every_m?: number): Course;
  planner(options?: { mission?: Mission; laps?: number; method?: string }): Planner;
  reset(): void;
}

/** Invalid input, or a module that stopped. */
export class ConelaneError extends Error {}

/** `source`: bytes, a compiled module or an address; `conelane.wasm` beside conelane.mjs where it is absent. */
export function load(source?: BufferSource | WebAssembly.Module | string | URL): Promise<Conelane>;
