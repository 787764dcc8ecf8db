/**
 * Needles: how thick they are, what each segment is to them, and how what happened is described.
 * Lengths [mm], forces [N].
 */
import { formatFixed } from "../base/format";
import type { NeedleEvent, Segment, TissueName } from "../protocol";

/** What a segment is to a needle: a tissue that it goes into, or hard. */
export type Layer = TissueName | "hard";

export const layers: readonly Layer[] = ["hard", "skin", "fat", "muscle", "liver"];

export interface Gauge {
  readonly name: string;
  /** Outer diameter. */
  readonly diameter: number;
}

/** Nominal outer diameters of hypodermic needles. */
export const gauges: readonly Gauge[] = [
  { name: "16 G", diameter: 1.65 },
  { name: "18 G", diameter: 1.27 },
  { name: "20 G", diameter: 0.91 },
  { name: "22 G", diameter: 0.72 },
  { name: "25 G", diameter: 0.51 },
];

const soft: readonly TissueName[] = ["skin", "fat", "muscle", "liver"];
const bones =
  /bone|skull|rib|spine|vertebra|pelvis|femur|sternum|tooth|teeth|jaw|mandible|cortical|metal|implant|plate/;

/** What a segment is by its name, as long as nobody has said: bone and thresholds are hard. */
export function likelyLayer({ name, made_by: madeBy }: Pick<Segment, "name" | "made_by">): Layer {
  const lower = name.toLowerCase();
  if (bones.test(lower)) {
    return "hard";
  }
  const tissue = soft.find((known) => lower.includes(known));
  return tissue ?? (madeBy === null ? "muscle" : "hard");
}

/** "punctured liver, 1.61 N at 12.3 mm" */
export function tellEvent(event: NeedleEvent, segments: readonly Pick<Segment, "id" | "name">[]): string {
  const name = segments.find(({ id }) => id === event.segment)?.name ?? "";
  switch (event.kind) {
    case "punctured":
      return `punctured ${name}, ${formatFixed(event.force, 2, "N")} at ${formatFixed(event.depth, 1, "mm")}`;
    case "crossed":
      return `${name === "" ? "out of all" : `into ${name}`} at ${formatFixed(event.depth, 1, "mm")}`;
    case "stopped":
      return `stopped by ${name} at ${formatFixed(event.depth, 1, "mm")}`;
    case "withdrawn":
      return "withdrawn";
  }
}
