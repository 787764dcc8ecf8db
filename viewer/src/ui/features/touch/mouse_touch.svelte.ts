/**
 * How the mouse touches in touch mode: on the surface under the pointer, with a pressure that the wheel changes, or by
 * the hand in the view plane. Remembered by the page.
 */
import { recall, remember } from "../../state/remembered";

export type MouseWay = "surface" | "plane";

/** The pointer while it presses, or while the wheel changes with how much. */
export interface Finger {
  /** Where it is in the 3-D view [CSS pixels]. */
  readonly x: number;
  readonly y: number;
  readonly presses: boolean;
}

/** Weakest and strongest pressure [N]. */
export const weakest = 0.1;
export const strongest = 5;
/**
 * Pressures before the wheel was turned [N]: to feel with, and for a drill, with which 5 N take some 5 mm³ of bone a
 * second.
 */
const usual = { feel: 1, drill: 5 } as const;
type Purpose = keyof typeof usual;
/** Change of the pressure per pixel of the wheel, as an exponent: a notch of 100 pixels is a tenth. */
const perPixel = Math.log(1.1) / 100;
/** So long the ring stays after the wheel was turned [ms]. */
const ringStays = 1500;

export class MouseTouch {
  way = $state<MouseWay>("surface");
  private pressures = $state.raw<Readonly<Record<Purpose, number>>>(usual);
  finger = $state.raw<Finger | null>(null);
  private hiding: ReturnType<typeof setTimeout> | undefined;

  /** @param drills tells whether a drill is in the hand: it has a pressure of its own. */
  constructor(private readonly drills: () => boolean) {
    const kept = recall<{ way: unknown; pressures: unknown }>("mouse", { way: null, pressures: null });
    this.way = kept.way === "plane" ? "plane" : "surface";
    this.pressures = sanePressures(kept.pressures);
  }

  /** With how much the mouse presses [N]. */
  get pressure(): number {
    return this.pressures[this.purpose];
  }

  private get purpose(): Purpose {
    return this.drills() ? "drill" : "feel";
  }

  choose(way: MouseWay): void {
    this.way = way;
    this.keep();
  }

  /** Presses harder or more gently by pixels of the wheel, and shows it at the pointer. */
  turn(pixels: number, x: number, y: number): void {
    this.pressures = { ...this.pressures, [this.purpose]: sane(this.pressure * Math.exp(-pixels * perPixel)) };
    this.keep();
    this.show({ x, y, presses: this.finger?.presses ?? false });
  }

  /** Shows the pointer that presses, or hides it. */
  show(finger: Finger | null): void {
    clearTimeout(this.hiding);
    this.finger = finger;
    if (finger?.presses === false) {
      this.hiding = setTimeout(() => {
        this.finger = null;
      }, ringStays);
    }
  }

  private keep(): void {
    remember("mouse", { way: this.way, pressures: this.pressures });
  }
}

/** What was kept, where that can be pressed with; else what is usual. */
function sanePressures(kept: unknown): Record<Purpose, number> {
  const given = (typeof kept === "object" && kept !== null ? kept : {}) as Partial<Record<Purpose, unknown>>;
  const sanePressure = (purpose: Purpose): number => {
    const pressure = given[purpose];
    return typeof pressure === "number" && Number.isFinite(pressure) ? sane(pressure) : usual[purpose];
  };
  return { feel: sanePressure("feel"), drill: sanePressure("drill") };
}

/** Within what can be pressed with, of a hundredth of a newton. */
function sane(pressure: number): number {
  return Math.round(Math.min(strongest, Math.max(weakest, pressure)) * 100) / 100;
}
