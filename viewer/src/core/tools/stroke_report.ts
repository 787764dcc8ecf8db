/**
 * What drilling strokes have done: volume, time at work and energy as the engine counts them, and from its samples of
 * force and the probe's places the forces and the path. Lengths [mm], volume [mm³], time [s], force [N], energy [mJ].
 */
import { formatFixed } from "../base/format";
import { distance, type Vec3 } from "../geometry/vector";
import type { State } from "../protocol";

export interface StrokeReport {
  /** Of all strokes since the scan was opened, from 1. */
  readonly number: number;
  readonly diameter: number;
  readonly volume: number;
  readonly time: number;
  /** While there was a force. */
  readonly meanForce: number;
  readonly peakForce: number;
  readonly energy: number;
  readonly path: number;
}

/** Less is no force [N]. */
const leastForce = 0.01;
/** A probe that seems to move faster was placed elsewhere [mm/s]. */
const fastest = 2000;

/** What the meter needs of a state. */
export type MeteredState = Pick<State, "time" | "proxy" | "samples" | "tool">;

/** Follows strokes from state to state. */
export class StrokeMeter {
  /** The stroke in progress; null between strokes. */
  private begun: { readonly time: number; readonly place: Vec3; readonly at: number } | null = null;
  private sum = 0;
  private count = 0;
  private peak = 0;
  private path = 0;
  private strokes = 0;
  /** The stroke in progress, else the last one; null before the first. */
  now: StrokeReport | null = null;

  /** Takes a state; returns the report of a stroke that has ended with it, and has worked. */
  take(state: MeteredState): StrokeReport | null {
    const { tool } = state;
    const isOn = tool.kind === "drill" && tool.on;
    if (isOn && this.begun === null) {
      this.begin(state);
    }
    if (this.begun === null) {
      return null;
    }
    this.add(state, this.begun.time);
    this.move(state, this.begun);
    if (tool.kind === "drill") {
      this.now = this.report(state);
    }
    if (isOn) {
      return null;
    }
    this.begun = null;
    const ended = this.now;
    const worked = ended !== null && ended.time > 0;
    this.strokes += worked ? 1 : 0;
    return worked ? ended : null;
  }

  private begin({ time, proxy }: MeteredState): void {
    this.begun = { time, place: proxy, at: time };
    this.sum = this.count = this.peak = this.path = 0;
  }

  private add({ samples }: MeteredState, since: number): void {
    for (const [time, x, y, z] of samples) {
      const force = Math.hypot(x, y, z);
      if (time >= since && force > leastForce) {
        this.sum += force;
        this.count += 1;
        this.peak = Math.max(this.peak, force);
      }
    }
  }

  private move({ time, proxy }: MeteredState, begun: NonNullable<StrokeMeter["begun"]>): void {
    const way = distance(begun.place, proxy);
    this.path += way > fastest * Math.max(time - begun.at, 1e-3) ? 0 : way;
    this.begun = { ...begun, place: proxy, at: time };
  }

  private report({ tool: { radius, volume, time, energy } }: MeteredState): StrokeReport {
    const { strokes, sum, count, peak, path } = this;
    return {
      number: strokes + 1,
      diameter: 2 * radius,
      volume,
      time,
      meanForce: count > 0 ? sum / count : 0,
      peakForce: peak,
      energy,
      path,
    };
  }
}

const columns: readonly (readonly [string, (report: StrokeReport) => string])[] = [
  ["stroke", ({ number }) => String(number)],
  ["burr diameter (mm)", ({ diameter }) => diameter.toFixed(2)],
  ["volume removed (mm3)", ({ volume }) => volume.toFixed(3)],
  ["time at work (s)", ({ time }) => time.toFixed(2)],
  ["mean force (N)", ({ meanForce }) => meanForce.toFixed(3)],
  ["peak force (N)", ({ peakForce }) => peakForce.toFixed(3)],
  ["energy (mJ)", ({ energy }) => energy.toFixed(1)],
  ["path (mm)", ({ path }) => path.toFixed(2)],
];

/** A table of strokes for a spreadsheet (RFC 4180), a line each. */
export function strokesTable(reports: readonly StrokeReport[]): string {
  const rows = reports.map((report) => columns.map(([, cell]) => cell(report)));
  return [columns.map(([name]) => name), ...rows].map((row) => `${row.join(",")}\r\n`).join("");
}

/** "820 mJ", "12.4 J" */
export function formatEnergy(energy: number): string {
  return energy < 1000 ? formatFixed(energy, 0, "mJ") : formatFixed(energy / 1000, 1, "J");
}
