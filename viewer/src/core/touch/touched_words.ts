/**
 * What is touched, or why nothing is felt, in one line of plain words.
 */
import { formatValue } from "../base/format";
import { addScaled, dot, type Vec3 } from "../geometry/vector";
import { tissueName } from "../picking/tissue_name";
import type { ClipPlanes, Safety, Scan, Segment, State } from "../protocol";
import { withoutNoise } from "../scan/stored_values";
import { presetName } from "../tissue/tissue";

/** What of a state tells it. */
export type TouchedState = Pick<
  State,
  "clutched" | "contact" | "contact_point" | "grabbed" | "matter" | "needle" | "normal" | "proxy" | "safety" | "touched"
>;

/** What the page knows of places in the scan. */
export interface Places {
  /** Value of the scan at a point of the scene; null outside of it and before it is here. */
  readonly valueAt: (point: Vec3) => number | null;
  /** The segment that a voxel belongs to, as far as it is known. */
  readonly segmentAt: (point: Vec3) => Segment | null;
}

/** What a state is told about. */
interface About {
  readonly scan: Told;
  readonly segments: readonly Segment[];
  readonly places: Places;
  /** Planes that touch is cut at. */
  readonly clip?: ClipPlanes;
}

type Told = Pick<Scan, "bone" | "slope" | "soft_tissue" | "spacing" | "unit">;

/** Why no force is sent although it would be computed. */
const off: Readonly<Record<NonNullable<Safety["off"]>, string>> = {
  "not-started": "No force yet: touch is starting",
  waiting: "No force until the hand comes out of the surface",
  "servo-late": "No force: the computer is too busy",
  stopped: "No force: the session has ended",
  "not-finite": "No force: it could not be computed",
};

/** What is done to a force that is sent. */
const held: Readonly<Record<Safety["force"], string | null>> = {
  on: null,
  waiting: "held back until it is small",
  ramping: "force is rising",
  easing: "force is easing off",
  off: "no force is sent",
};

/** "bone · rigid · 743 HU", or "Free: in bone, which is hidden". */
export function touchedWords(
  state: TouchedState,
  { scan, segments, places, clip = [] }: About,
): string {
  const nameOf = (id: number): string => segments.find((segment) => segment.id === id)?.name ?? "a segment";
  const { needle, safety } = state;
  if (safety.off !== null) {
    return off[safety.off];
  }
  if (needle.inside) {
    return join([`Needle in ${needle.segment === 0 ? "no segment" : nameOf(needle.segment)}`, held[safety.force]]);
  }
  if (state.contact) {
    const segment = segments.find(({ id }) => id === state.touched) ?? segmentBehind(state, { scan, places });
    const value = segment === null ? null : valueBehind(state, segment, { scan, places });
    return join([segment?.name ?? "a segment", materialOf(segment, state), value, held[safety.force]]);
  }
  if (state.grabbed !== 0) {
    return `Holds ${nameOf(state.grabbed)}: what is held is not felt`;
  }
  if (state.clutched) {
    return "Clutch: the device moves without the probe";
  }
  return whyFree(state, { scan, segments, places, clip });
}

function join(parts: readonly (string | null)[]): string {
  return parts.filter((part) => part !== null).join(" · ");
}

/** Whose surface is touched where the probe rests on the smooth surface, and no voxel holds it yet. */
function segmentBehind(
  { contact_point, normal, touched }: TouchedState,
  { scan, places }: { readonly scan: Told; readonly places: Places },
): Segment | null {
  const [step, farthest] = [0.5 * Math.min(...scan.spacing), Math.max(...scan.spacing)];
  for (let depth = step; touched === 0 && depth <= farthest; depth += step) {
    const behind = places.segmentAt(addScaled(contact_point, normal, -depth));
    if (behind?.felt === true) {
      return behind;
    }
  }
  return null;
}

function materialOf(segment: Segment | null, { matter }: TouchedState): string | null {
  if (segment === null) {
    return null;
  }
  const { material } = segment;
  // without a model all is hard, whatever it is made of
  if (material === null || matter.model === null) {
    // @texts
    return "hard";
  }
  return material.preset === null ? "own material" : presetName(material.preset).toLowerCase();
}

/** The scan's value a voxel behind the surface that is touched; null where the scan has not got the segment there. */
function valueBehind(
  { contact_point, normal }: TouchedState,
  { grid, pose }: Segment,
  { scan, places }: { readonly scan: Told; readonly places: Places },
): string | null {
  if (grid !== null || pose !== null) {
    return null;
  }
  return valueText(places.valueAt(addScaled(contact_point, normal, -Math.min(...scan.spacing))), scan);
}

function valueText(value: number | null, scan: Told): string | null {
  return value === null ? null : formatValue(withoutNoise(value, scan), scan.unit);
}

function whyFree({ proxy }: TouchedState, { scan, segments, places, clip = [] }: About): string {
  if (segments.length === 0) {
    return "Free: there is no segment to touch";
  }
  const around = places.segmentAt(proxy);
  const isCut = clip.some(([normal, offset]) => dot(normal, proxy) > offset);
  const why = around === null ? null : whyUnfelt(around, isCut);
  if (around !== null && why !== null) {
    return `Free: in ${around.name}, ${why}`;
  }
  if (!segments.some(({ felt }) => felt)) {
    return "Free: no segment can be touched now";
  }
  const value = places.valueAt(proxy);
  return value === null || value < scan.bone || around !== null
    ? "Free: nothing is touched"
    : `Free: in ${tissueName(value, scan)} of no segment`;
}

function whyUnfelt({ felt, pending, touchable }: Segment, isCut: boolean): string | null {
  if (felt && isCut) {
    return "which is cut away here";
  }
  if (felt) {
    return pending ? "which waits for the probe to leave" : null;
  }
  return touchable ? "which is hidden" : "which lets the probe pass";
}
