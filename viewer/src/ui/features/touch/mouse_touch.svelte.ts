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
/** Change of the pressure per pixel of the wheel, as an exponent: a notch of 100 pixels is a tenth. */
const perPixel = Math.log(1.1) / 100;
/** So long the ring stays after the wheel was turned [ms]. */
const ringStays = 1500;

export class MouseTouch {
  way = $state<MouseWay>("surface");
  /** With how much the mouse presses [N]. */
  pressure = $state(1);
  finger = $state.raw<Finger | null>(null);
  private hiding: ReturnType<typeof setTimeout> | undefined;

  constructor() {
    const kept = recall<{ way: unknown; pressure: unknown }>("mouse", { way: null, pressure: null });
    this.way = kept.way === "plane" ? "plane" : "surface";
    this.pressure = typeof kept.pressure === "number" ? sane(kept.pressure) : 1;
  }

  choose(way: MouseWay): void {
    this.way = way;
    this.keep();
  }

  /** Presses harder or more gently by pixels of the wheel, and shows it at the pointer. */
  turn(pixels: number, x: number, y: number): void {
    this.pressure = sane(this.pressure * Math.exp(-pixels * perPixel));
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
    remember("mouse", { way: this.way, pressure: this.pressure });
  }
}

/** A pressure that can be pressed with, of a hundredth of a newton. */
function sane(pressure: number): number {
  return Number.isFinite(pressure) ? Math.round(Math.min(strongest, Math.max(weakest, pressure)) * 100) / 100 : 1;
}
