/**
 * Stereo on a normal screen: where the two eyes stand, and where their pictures go.
 *
 * Both eyes look straight ahead, side by side, through one window that stands at the camera's target
 * (off-axis frusta): what lies there has no parallax, what is nearer stands before the screen. Nothing is
 * turned inward, which would shift things up and down as well.
 * Source: Bourke, "Calculating stereo pairs" (1999).
 */
import type { Camera, Viewport } from "../geometry/camera";
import type { Eye } from "./gizmo";
import type { Rect } from "./picture_layout";

/** One picture for one eye; two mixed by colours; two beside or above one another. */
export const stereoModes = ["off", "anaglyph", "side", "stacked"] as const;
export type StereoMode = (typeof stereoModes)[number];

export interface Stereo {
  readonly mode: StereoMode;
  /** From eye to eye [share of the distance to the target]. */
  readonly separation: number;
  /** Pictures beside one another fill half of the width or height each, as 3-D screens take them. */
  readonly squeezed: boolean;
  /** The right eye's picture comes first: to squint at, or for glasses that are cyan at the left. */
  readonly swapped: boolean;
}

/** Eyes a thirtieth of the distance apart: comfortable for most people, with the usual depth of a scene. */
export const firstStereo: Stereo = { mode: "off", separation: 1 / 30, squeezed: false, swapped: false };
export const separations = { least: 0.005, most: 0.1 } as const;

/** What was kept of it, made sane. */
export function saneStereo({ mode, separation, squeezed, swapped }: Readonly<Record<keyof Stereo, unknown>>): Stereo {
  const { least, most } = separations;
  return {
    mode: stereoModes.find((known) => known === mode) ?? "off",
    separation:
      typeof separation === "number" && separation >= least && separation <= most ? separation : firstStereo.separation,
    squeezed: squeezed === true,
    swapped: swapped === true,
  };
}

/** One picture of those that are shown. */
export interface EyePlace {
  /** How far to the right the eye stands [share of the distance to the target]. */
  readonly aside: number;
  /** Where its picture goes [CSS pixels from the pane's upper left corner]. */
  readonly rect: Rect;
}

/**
 * What lies over an eye's picture stands in pixels of what it sees, which may be squeezed into its part of the pane.
 */
export interface ShownEye extends Eye {
  /** Where its picture is [CSS pixels from the pane's upper left corner]. */
  readonly rect: Rect;
  /** Pixels of what it sees per CSS pixel, to the right and down. */
  readonly stretch: readonly [number, number];
}

/** The pictures that fill a pane, in the order of the eyes they are for. */
export function eyesOf({ mode, separation, swapped }: Stereo, { width, height }: Viewport): readonly EyePlace[] {
  const whole = { x: 0, y: 0, width, height };
  if (mode === "off") {
    return [{ aside: 0, rect: whole }];
  }
  const [halfWidth, halfHeight] = [Math.max(1, Math.floor(width / 2)), Math.max(1, Math.floor(height / 2))];
  const [first, second] = {
    anaglyph: [whole, whole] as const,
    side: [{ ...whole, width: halfWidth }, { ...whole, x: width - halfWidth, width: halfWidth }] as const,
    stacked: [{ ...whole, height: halfHeight }, { ...whole, y: height - halfHeight, height: halfHeight }] as const,
  }[mode];
  const right = (swapped ? -separation : separation) / 2;
  return [
    { aside: -right, rect: first },
    { aside: right, rect: second },
  ];
}

/** Size of what an eye sees: of its picture, or of the pane where that is squeezed into its picture. */
export function viewportOf(stereo: Stereo, pane: Viewport): Viewport {
  const rect = eyesOf(stereo, pane)[0]?.rect ?? pane;
  return stereo.squeezed ? { width: pane.width, height: pane.height } : { width: rect.width, height: rect.height };
}

/** The view of an eye. */
export function eyeCamera(camera: Camera, aside: number): Camera {
  return aside === 0 ? camera : { ...camera, aside };
}

/**
 * The picture that a place of the pane lies in; x and y in CSS pixels from the pane's corner. Mixed
 * pictures are pointed at by an eye between the two.
 */
export function pointedEye(stereo: Stereo, pane: Viewport, x: number, y: number): EyePlace {
  const [first, second] = eyesOf(stereo, pane);
  if (first === undefined || second === undefined || stereo.mode === "anaglyph") {
    return { aside: 0, rect: { x: 0, y: 0, width: pane.width, height: pane.height } };
  }
  return x >= second.rect.x && y >= second.rect.y ? second : first;
}
