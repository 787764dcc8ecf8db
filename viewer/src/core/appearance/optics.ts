/**
 * How the values along a ray become one colour: the optical model, and what each of them needs.
 * Values are in the unit of the scan, lengths in mm.
 *
 * Source: Max, "Optical models for direct volume rendering", IEEE TVCG 1 (1995).
 */
import { looks } from "./looks";
import type { WindowLevel } from "./window_level";

/** In the order of the numbers in `gl/shaders/blends.glsl`. */
export const blends = ["shaded", "composite", "absorption", "emission", "mip", "minip", "average", "iso"] as const;
export type Blend = (typeof blends)[number];

/** Modes that show one value of each ray, as grey. */
export const greyBlends = ["mip", "minip", "average"] as const;
export type GreyBlend = (typeof greyBlends)[number];

export function isGrey(blend: Blend): blend is GreyBlend {
  return greyBlends.some((grey) => grey === blend);
}

/** Whether the transfer function tells how tissue looks. */
export function usesTransferFunction(blend: Blend): boolean {
  return !isGrey(blend) && blend !== "iso";
}

/** Whether solid segments stand in the picture; elsewhere their voxels are values like all others. */
export function drawsSolids(blend: Blend): boolean {
  return blend === "shaded" || blend === "composite" || blend === "iso";
}

/** Whether what is drawn is lit, and so casts shadows. */
export function isLit(blend: Blend): boolean {
  return blend === "shaded" || blend === "iso";
}

/**
 * Whether what a pixel shows has a depth by which the picture can be turned to a view nearby. In a slab it has none:
 * the slab turns with the view, and other tissue comes into it.
 */
export function hasDepth({ blend, slab }: Pick<Optics, "blend" | "slab">): boolean {
  return drawsSolids(blend) || slab === null;
}

export interface Optics {
  readonly blend: Blend;
  /** Factor on all extinction. */
  readonly density: number;
  /** Values that are black and white in modes of grey. */
  readonly window: WindowLevel;
  /** Value of the iso-surface. */
  readonly isoValue: number;
  /** Value from which on there is tissue: what counts lies between the first and the last on a ray. */
  readonly tissueFrom: number;
  /** Thickness of what is looked at around the middle of the view [mm]; null: all of it. */
  readonly slab: number | null;
}

export const shadedOptics: Optics = {
  blend: "shaded",
  density: 1,
  window: { window: 400, level: 40 },
  isoValue: 250,
  tissueFrom: -300,
  slab: null,
};

/** Share of the window at a biased or physical value: black at 0, white at 1. */
export function greyOf(value: number, { window, level }: WindowLevel): number {
  return (value - level) / Math.max(window, 1e-6) + 0.5;
}

/** Whether values from `low` to `high` are seen at all: monotone in grey, so the ends tell. */
export function seenInGrey(optics: Pick<Optics, "blend" | "window" | "isoValue">, low: number, high: number): boolean {
  switch (optics.blend) {
    case "mip":
      return Math.max(greyOf(low, optics.window), greyOf(high, optics.window)) > 0;
    case "iso":
      return Math.max(low, high) >= optics.isoValue;
    default:
      // the least and the mean depend on everything
      return true;
  }
}

/** What a person has chosen, for all modes: each keeps its own. */
export interface OpticsChoice {
  readonly blend: Blend;
  readonly densities: Readonly<Record<"shaded" | "composite" | "absorption" | "emission", number>>;
  readonly windows: Readonly<Record<GreyBlend, WindowLevel>>;
  /** Thickness of slabs [mm]; 0: all of the scan. */
  readonly slabs: Readonly<Record<GreyBlend, number>>;
  readonly isoValue: number;
}

/** Values of soft tissue and of bone, after which everything is set first. */
interface Anchors {
  readonly softTissue: number;
  readonly bone: number;
}

/** Value at a place in tissue units: 0 at soft tissue, 1 at bone (see `appearance.ts`). */
function valueAt(place: number, { softTissue, bone }: Anchors): number {
  return softTissue + place * (bone - softTissue);
}

/** Value of fat, from which on there is tissue and no cushion: with CT values about -130 HU. */
export function firstTissue(anchors: Anchors): number {
  return valueAt(looks.modes.firstTissue, anchors);
}

/** @param brightest value that hardly any voxel exceeds */
export function firstChoice(anchors: Anchors, brightest: number): OpticsChoice {
  const fromTo = (low: number, high: number): WindowLevel => ({ window: high - low, level: (low + high) / 2 });
  const between = ([low, high]: readonly [number, number]): WindowLevel =>
    fromTo(valueAt(low, anchors), valueAt(high, anchors));
  const { densities, slabs, windows } = looks.modes;
  return {
    blend: "shaded",
    densities,
    // vessels and bone; lungs and airways; everything
    windows: {
      mip: fromTo(valueAt(windows.mip[0], anchors), Math.max(brightest, anchors.bone)),
      minip: between(windows.minip),
      average: between(windows.average),
    },
    // of all of a body the least and the mean are those of the air between it and the table
    slabs,
    isoValue: anchors.bone,
  };
}

/** The optics of what was chosen. */
export function opticsOf(choice: OpticsChoice, anchors: Anchors): Optics {
  const { blend, densities, slabs, windows } = choice;
  const slab = isGrey(blend) ? slabs[blend] : 0;
  return {
    blend,
    density: isGrey(blend) || blend === "iso" ? 1 : densities[blend],
    window: isGrey(blend) ? windows[blend] : windows.average,
    isoValue: choice.isoValue,
    // a slab is inside of the body: there all counts, lungs too
    tissueFrom: slab > 0 ? -1e9 : firstTissue(anchors),
    slab: slab > 0 ? slab : null,
  };
}
