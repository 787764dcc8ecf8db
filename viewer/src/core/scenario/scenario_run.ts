/**
 * What a tool did and felt in a scenario: the file of `palpate scenario --json`, to be played.
 *
 * Frame: scene, LPS [mm]; s, N, N/mm.
 */
import { addScaled, length, scale, subtract, type Vec3 } from "../geometry/vector";

export interface RunEvent {
  readonly kind: string;
  readonly segment: string;
  readonly time: number;
  readonly force: number;
}

/** What one place of a palpation feels like. */
export interface Press {
  /** How far along the line of places [mm]. */
  readonly along: number;
  /** What is soft over the first bone [mm]; null where there is none. */
  readonly thickness: number | null;
  /** [N/mm] */
  readonly stiffness: number;
}

export interface ScenarioRun {
  readonly scenario: string;
  readonly scan: string;
  /** Names of the segments, which are numbered from 1. */
  readonly layers: readonly string[];
  /** Of the tool's ball [mm]; 0 for a tip. */
  readonly radius: number;
  readonly phases: readonly string[];
  /** Rising [s]. */
  readonly time: Float64Array;
  /** The columns x, y and z of the tool [mm], and its force [N], against the way in where positive. */
  readonly tool: readonly [Float64Array, Float64Array, Float64Array];
  readonly force: Float64Array;
  /** How far the tool is along the drive's way [mm]. */
  readonly tip: Float64Array;
  /** Number of the layer at the tool; 0 where there is none. */
  readonly segment: Float64Array;
  /** Number of the press of a palpation; all 0 of other runs. */
  readonly press: Float64Array;
  /** Unit vector of the way in, for each press. */
  readonly ways: readonly Vec3[];
  readonly events: readonly RunEvent[];
  readonly presses: readonly Press[];
}

/** Where the tool is and what it feels at a time. */
export interface Moment {
  readonly time: number;
  readonly tool: Vec3;
  /** Unit vector of the way in. */
  readonly way: Vec3;
  /** On the hand [N]. */
  readonly force: Vec3;
  /** Against the way in [N]. */
  readonly magnitude: number;
  /** Along the drive's way [mm]. */
  readonly depth: number;
  readonly phase: string;
  readonly layer: string;
  readonly press: number;
}

const format = "palpate-scenario-1";
const phaseNames: readonly string[] = ["in", "rest", "out"];

/** A file is no run: what was found, what is allowed. */
export class RunError extends Error {}

/**
 * Reads the text of a run's file.
 *
 * @throws RunError where it is none.
 */
export function parseRun(text: string): ScenarioRun {
  const told = parsed(text);
  if (told["format"] !== format) {
    const found = JSON.stringify(told["format"] ?? null).slice(0, 40);
    throw new RunError(`its format is ${found}, not "${format}". Make it with palpate scenario --json`);
  }
  const samples = record(told["samples"], "samples");
  const time = column(samples, "time");
  const rows = time.length;
  if (rows < 2 || time.some((t, i) => i > 0 && t <= (time[i - 1] ?? 0))) {
    throw new RunError("its times do not rise from sample to sample, or it has only one");
  }
  const of = (name: string): Float64Array => {
    const numbers = column(samples, name);
    if (numbers.length !== rows) {
      throw new RunError(`column ${name} has ${String(numbers.length)} samples, and time has ${String(rows)}`);
    }
    return numbers;
  };
  const phases = list(told["phase"], "phase").map(String);
  if (phases.length !== rows || phases.some((phase) => !phaseNames.includes(phase))) {
    throw new RunError(`its phases are not one of ${phaseNames.join(", ")} for each sample`);
  }
  const presses = list(told["presses"], "presses").map(pressOf);
  const press = "press" in samples ? of("press") : new Float64Array(rows);
  if (press.some((number) => !Number.isInteger(number) || number < 0 || number >= Math.max(1, presses.length))) {
    throw new RunError("its samples name a press that is not there");
  }
  const run = {
    scenario: String(told["scenario"]),
    scan: String(told["scan"]),
    layers: list(told["layers"], "layers").map(String),
    radius: number(told["radius"], "radius"),
    phases,
    time,
    tool: [of("x"), of("y"), of("z")] as const,
    force: of("force"),
    tip: of("tip"),
    segment: of("segment"),
    press,
    events: list(told["events"], "events").map(eventOf),
    presses,
  };
  return { ...run, ways: Array.from({ length: Math.max(1, presses.length) }, (_, i) => wayOf(run, i)) };
}

/** What a run tells of a time [s]; before its start and after its end what it tells there. */
export function momentAt(run: ScenarioRun, time: number): Moment {
  const row = rowAt(run.time, time);
  const press = run.press[row] ?? 0;
  const way = run.ways[press] ?? [0, 0, 0];
  const magnitude = run.force[row] ?? 0;
  return {
    time,
    tool: toolAt(run, row),
    way,
    force: scale(way, -magnitude),
    magnitude,
    depth: run.tip[row] ?? 0,
    phase: run.phases[row] ?? "",
    layer: run.layers[(run.segment[row] ?? 0) - 1] ?? "",
    press,
  };
}

/** Seconds before a time (negative) and magnitudes of the force [N], the oldest first, as the live plot has them. */
export function forceBefore({ time, force }: ScenarioRun, now: number, seconds: number): readonly [number[], number[]] {
  const rows = [...time.keys()].filter((row) => (time[row] ?? 0) >= now - seconds && (time[row] ?? 0) <= now);
  return [rows.map((row) => (time[row] ?? 0) - now), rows.map((row) => Math.abs(force[row] ?? 0))];
}

/** When a run ends [s]. */
export function endOf(run: ScenarioRun): number {
  return run.time.at(-1) ?? 0;
}

/** Where in the scene a tool's holder ends, as far behind the tool as this [mm]. */
export function holderOf({ tool, way }: Moment, behind: number): Vec3 {
  return addScaled(tool, way, -behind);
}

/** The last row that is not after a time. */
function rowAt(times: Float64Array, time: number): number {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if ((times[middle] ?? Infinity) <= time) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

function toolAt({ tool }: Pick<ScenarioRun, "tool">, row: number): Vec3 {
  return [tool[0][row] ?? 0, tool[1][row] ?? 0, tool[2][row] ?? 0];
}

/** From where a press's tool is least far to where it is furthest. */
function wayOf(run: Pick<ScenarioRun, "tool" | "tip" | "press">, press: number): Vec3 {
  let least = -1;
  let most = -1;
  run.tip.forEach((tip, row) => {
    if (run.press[row] === press) {
      least = least < 0 || tip < (run.tip[least] ?? 0) ? row : least;
      most = most < 0 || tip > (run.tip[most] ?? 0) ? row : most;
    }
  });
  if (least < 0) {
    return [0, 0, 0];
  }
  const way = subtract(toolAt(run, most), toolAt(run, least));
  const long = length(way);
  return long > 0 ? scale(way, 1 / long) : [0, 0, 0];
}

function parsed(text: string): Record<string, unknown> {
  try {
    return record(JSON.parse(text), "file");
  } catch (error) {
    if (error instanceof RunError) {
      throw error;
    }
    throw new RunError("it is no JSON. Make it with palpate scenario --json");
  }
}

function record(given: unknown, name: string): Record<string, unknown> {
  if (typeof given !== "object" || given === null || Array.isArray(given)) {
    throw new RunError(`its ${name} is no object`);
  }
  return given as Record<string, unknown>;
}

function list(given: unknown, name: string): readonly unknown[] {
  if (!Array.isArray(given)) {
    throw new RunError(`its ${name} is no list`);
  }
  return given;
}

function column(samples: Record<string, unknown>, name: string): Float64Array {
  const numbers = list(samples[name], `column ${name}`);
  if (!numbers.every((one) => typeof one === "number" && Number.isFinite(one))) {
    throw new RunError(`its column ${name} has something that is no number`);
  }
  return Float64Array.from(numbers as readonly number[]);
}

function number(given: unknown, name: string): number {
  if (typeof given !== "number" || !Number.isFinite(given)) {
    throw new RunError(`its ${name} is no number`);
  }
  return given;
}

function eventOf(given: unknown): RunEvent {
  const event = record(given, "event");
  return {
    kind: String(event["kind"]),
    segment: String(event["segment"]),
    time: number(event["time"], "event's time"),
    force: number(event["force"], "event's force"),
  };
}

function pressOf(given: unknown): Press {
  const press = record(given, "press");
  return {
    along: number(press["along"], "press's place"),
    thickness: press["thickness"] === null ? null : number(press["thickness"], "press's thickness"),
    stiffness: number(press["stiffness"], "press's stiffness"),
  };
}
