/**
 * What the sticks and buttons of a gamepad mean, and how it rumbles: pure, for pads in the
 * "standard" arrangement (W3C Gamepad, section 4).
 */
import { clamp01 } from "./contact_sound";
import type { State } from "../protocol";
import { distance, length } from "../geometry/vector";

export interface Pad {
  readonly axes: readonly number[];
  readonly buttons: readonly { readonly pressed: boolean; readonly value: number }[];
}

/** Buttons and axes of the standard arrangement. */
export const button = {
  south: 0,
  east: 1,
  west: 2,
  north: 3,
  leftShoulder: 4,
  rightShoulder: 5,
  leftTrigger: 6,
  rightTrigger: 7,
} as const;
const axis = { leftX: 0, leftY: 1, rightX: 2, rightY: 3 } as const;

/** Sticks at rest are not quite in the middle. */
const deadZone = 0.15;
/** Of the hand with the stick at its end, and with the left shoulder held [pixels/s]. */
const handSpeed = 160;
const fineShare = 0.2;
/** Of the picture with the stick at its end [rad/s]. */
const turnSpeed = 1.8;

/** A stick without its dead zone: 0 inside of it, then rising evenly, squared, to 1 at its end. */
export function stick(x: number, y: number): readonly [number, number] {
  const size = Math.hypot(x, y);
  if (!(size > deadZone)) {
    return [0, 0];
  }
  const beyond = Math.min(1, (size - deadZone) / (1 - deadZone));
  const factor = (beyond * beyond) / size;
  return [x * factor, y * factor];
}

export interface PadMove {
  /** Of the hand, in the view's axes [pixels/s]. */
  readonly right: number;
  readonly down: number;
  readonly away: number;
  /** Of the picture [rad/s]. */
  readonly turn: readonly [number, number];
}

/**
 * What the sticks do: the left one moves the hand in the view plane, triggers move it away
 * and back, the right one turns the picture. While touch is off the left stick turns too.
 */
export function moveOf(pad: Pad, touching: boolean): PadMove {
  const at = (i: number): number => pad.axes[i] ?? 0;
  const trigger = (i: number): number => stick(pad.buttons[i]?.value ?? 0, 0)[0];
  const left = stick(at(axis.leftX), at(axis.leftY));
  const right = stick(at(axis.rightX), at(axis.rightY));
  const speed = touching ? handSpeed * (pad.buttons[button.leftShoulder]?.pressed === true ? fineShare : 1) : 0;
  const turning = touching ? right : ([left[0] + right[0], left[1] + right[1]] as const);
  return {
    right: speed * left[0],
    down: speed * left[1],
    away: speed * (trigger(button.rightTrigger) - trigger(button.leftTrigger)),
    turn: [-turnSpeed * turning[0], -turnSpeed * turning[1]],
  };
}

/** Buttons that are pressed now and were not before. */
export function pressed(before: Pad | null, now: Pad): readonly number[] {
  return now.buttons.flatMap(({ pressed: down }, i) => (down && before?.buttons[i]?.pressed !== true ? [i] : []));
}

// --- rumble -----------------------------------------------------------------------------

/** The two motors of a pad, 0..1: the strong one hums low, the weak one buzzes high. */
export interface Rumble {
  readonly strong: number;
  readonly weak: number;
}

/** A pad that hums at full force all the time would numb the hand. */
const steadyShare = 0.45;
const beginning = 0.7;
/** A change of this share of the full force between two looks buzzes as strong as it gets. */
const strongChange = 0.25;

/** How a pad rumbles for a state after another one; `fullForce` [N]. */
export function rumbleOf(before: Felt | null, now: Felt, fullForce: number): Rumble {
  const share = clamp01(length(now.force) / fullForce);
  const change = before === null ? 0 : clamp01(distance(now.force, before.force) / (strongChange * fullForce));
  const begins = now.contact && before?.contact === false ? beginning : 0;
  return {
    strong: now.contact && share > 0.02 ? steadyShare * Math.sqrt(share) : 0,
    weak: clamp01(Math.max(begins, change > 0.05 ? change : 0)),
  };
}

export type Felt = Pick<State, "force" | "contact">;
