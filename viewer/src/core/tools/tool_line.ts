/**
 * The line of a tool: which way its shaft leads outward, how long and how thick it is. A probe has a place and no
 * direction: outward is the way that is known of a needle in tissue, else against the direction that was set for it or
 * against the push, else toward a hand beside the viewer. Scene [mm].
 */
import type { Camera } from "../geometry/camera";
import type { State, ToolKind } from "../protocol";
import type { NeedlePlan } from "./needle_plan";
import { add, length, normalize, scale, type Vec3 } from "../geometry/vector";

/** The line that a needle goes in along: in tissue its tip stays on it. Scene [mm]. */
export interface NeedleLine {
  /** Where it went in. */
  readonly entry: Vec3;
  /** Inward, of length 1. */
  readonly direction: Vec3;
}

/** What of the state tells how a tool is held. */
type Held = Pick<State, "tool" | "needle" | "force" | "contact">;

interface Rod {
  readonly radius: number;
  readonly length: number;
}

export interface ToolLine {
  /** Outward from the tip, of length 1. */
  readonly axis: Vec3;
  readonly shaft: Rod;
  readonly grip: Rod;
  /** Where a needle went in; null of other tools and outside. */
  readonly entry: Vec3 | null;
  /** Target and entry that were planned; null without a plan. */
  readonly plan: NeedlePlan | null;
}

/** Shares of right, up and toward the viewer of the way to a hand that holds a tool before the picture. */
const hand = [0.55, -0.35, 0.75] as const;
/** A weaker push has no direction [N]. */
const leastPush = 0.05;

/** Outward toward a hand that holds the tool before the picture. */
export function towardHand({ right, up, back }: Pick<Camera, "right" | "up" | "back">): Vec3 {
  return normalize(add(add(scale(right, hand[0]), scale(up, hand[1])), scale(back, hand[2])));
}

/** Outward from a needle's tip that is pushed; null where no push tells. @param force on the hand [N]. */
export function againstPush(force: Vec3): Vec3 | null {
  return length(force) < leastPush ? null : normalize(force);
}

/** Shaft and grip of a tool with a ball of this radius; null of one that has none. */
export function rodsOf(kind: ToolKind, radius: number): Pick<ToolLine, "shaft" | "grip"> | null {
  switch (kind) {
    case "drill":
      // as burrs of surgery are, of which the shaft is 2.35 mm thick
      return { shaft: { radius: Math.min(1.175, 0.6 * radius), length: 45 }, grip: { radius: 6, length: 60 } };
    case "needle":
      return { shaft: { radius, length: 120 }, grip: { radius: 3, length: 14 } };
    default:
      return null;
  }
}

/** The line of a needle in tissue; null of other tools and outside. */
export function needleLine({ tool, needle }: Pick<State, "tool" | "needle">): NeedleLine | null {
  return tool.kind === "needle" && needle.inside ? needle : null;
}

/**
 * The line of the tool in the hand, as it stands before this camera; null of one that is a ball alone.
 * @param plan of a needle.
 */
export function toolLine(
  state: Held,
  camera: Pick<Camera, "right" | "up" | "back">,
  plan: NeedlePlan | null,
): ToolLine | null {
  const { kind, radius } = state.tool;
  const rods = rodsOf(kind, radius);
  if (rods === null) {
    return null;
  }
  const isNeedle = kind === "needle";
  const inside = needleLine(state);
  const axis = isNeedle ? needleAxis(state, inside) : null;
  return { ...rods, axis: axis ?? towardHand(camera), entry: inside?.entry ?? null, plan: isNeedle ? plan : null };
}

/** Outward along a needle; null where nothing tells its direction. */
function needleAxis({ needle, force, contact }: Held, inside: NeedleLine | null): Vec3 | null {
  const inward = inside?.direction ?? needle.set_direction;
  if (inward !== null) {
    return scale(inward, -1);
  }
  return contact ? againstPush(force) : null;
}
