/**
 * The browser's gamepads (W3C Gamepad): the one in use, and its motors, whatever the browser
 * calls them. Everything else about gamepads is pure and stands in `core/touch/gamepad.ts`.
 */
import type { Pad, Rumble } from "../../../core/touch/gamepad";

/** Motors as browsers have them; the types of the DOM know only some. */
interface Motors {
  readonly playEffect?: (kind: string, effect: object) => Promise<unknown>;
  readonly reset?: () => Promise<unknown>;
  /** Firefox: one motor, one strength. */
  readonly pulse?: (strength: number, milliseconds: number) => Promise<unknown>;
}

export interface ConnectedPad extends Pad {
  readonly id: string;
  readonly index: number;
  readonly vibrationActuator?: Motors | null;
  readonly hapticActuators?: readonly Motors[];
}

/** The gamepad that was used last; null where there is none, or the browser knows of none. */
export function usedPad(): ConnectedPad | null {
  try {
    const pads = navigator.getGamepads().filter((pad) => pad?.connected);
    pads.sort((a, b) => (b?.timestamp ?? 0) - (a?.timestamp ?? 0));
    return (pads[0] ?? null) as ConnectedPad | null;
  } catch {
    // a page that is embedded may be forbidden to ask
    return null;
  }
}

/** A name without the numbers that browsers put around it. */
export function padName(pad: ConnectedPad): string {
  const name = pad.id.replace(/\(.*?\)/g, "").replace(/^[0-9a-f]{4}-[0-9a-f]{4}-/i, "").trim();
  return name === "" ? "Gamepad" : name;
}

export function canRumble(pad: ConnectedPad): boolean {
  return motorsOf(pad) !== null;
}

/** Runs the motors for a while; a pad without motors, or a busy one, is left alone. */
export function rumble(pad: ConnectedPad, { strong, weak }: Rumble, milliseconds: number): void {
  const motors = motorsOf(pad);
  const ignore = (): void => undefined;
  if (motors?.playEffect !== undefined) {
    const silent = strong === 0 && weak === 0 && motors.reset !== undefined;
    const effect = { startDelay: 0, duration: milliseconds, strongMagnitude: strong, weakMagnitude: weak };
    (silent ? motors.reset() : motors.playEffect("dual-rumble", effect)).catch(ignore);
  } else if (motors?.pulse !== undefined) {
    motors.pulse(Math.max(strong, weak), milliseconds).catch(ignore);
  }
}

function motorsOf(pad: ConnectedPad): Motors | null {
  return pad.vibrationActuator ?? pad.hapticActuators?.[0] ?? null;
}
