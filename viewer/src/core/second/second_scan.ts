/**
 * A second scan that is shown with the first: where it lies in it, and how both are shown together.
 * Frames: grid of each scan; patient of each [mm]. Points of the first are taken to the second's.
 */
import { affineFromRows, columnMajor, composed, type Affine } from "../geometry/affine";
import type { GreyBlend } from "../appearance/optics";
import type { SecondScan } from "../protocol";
import type { Isoline } from "./isolines";
import type { ScanFrame } from "../scan/scan_volume";
import type { TransferFunction } from "../appearance/transfer_function";
import type { WindowLevel } from "../appearance/window_level";

/** How two scans are shown: one through the other, in squares or cells by turns, or one after the other. */
export const fusions = ["blend", "checkerboard", "flicker"] as const;
export type Fusion = (typeof fusions)[number];

/** Colours of the second scan in slices, from black to white. In the order of `shaders/second/second_grey.glsl`. */
export const tints = ["warm", "cool", "grey"] as const;
export type Tint = (typeof tints)[number];

export interface SecondAppearance {
  readonly inView: boolean;
  readonly inSlices: boolean;
  /** In the 3-D view. */
  readonly viewFusion: Fusion;
  readonly transferFunction: TransferFunction;
  /** Factor on its extinction. */
  readonly density: number;
  /** Gradient [value per mm] of a full boundary. */
  readonly edgeGradient: number;
  /** Value of its iso-surface, and from which on there is tissue. */
  readonly isoValue: number;
  readonly tissueFrom: number;
  /** Where a ray has one value. */
  readonly windows: Readonly<Record<GreyBlend, WindowLevel>>;
  /** In slices. */
  readonly window: WindowLevel;
  readonly fusion: Fusion;
  readonly tint: Tint;
  /** Share of the second scan, 0..1, in slices, by one value of a ray, and of its iso-surface. */
  readonly opacity: number;
  /** Edge of a square or a cell of the checkerboard [mm]. */
  readonly square: number;
  /** Lines of equal value in slices, drawn in this order. */
  readonly lines: readonly Isoline[];
  /** Of two that flicker the one that is seen now. */
  readonly turn: "first" | "second";
}

/** Where the second scan lies; null where there is none. */
export function placeOf({ scan, second_from_first }: SecondScan): Affine | null {
  return scan === null ? null : affineFromRows(second_from_first);
}

/** From the grid of the first scan to shares of the second, 0..1 inside of it; column-major 4×4. */
export function sharesFromGrid(
  first: ScanFrame,
  { dimensions, gridFromScene }: ScanFrame,
  secondFromFirst: Affine,
): number[] {
  const [x, y, z] = dimensions;
  const shares: Affine = [1 / x, 0, 0, 0, 0, 1 / y, 0, 0, 0, 0, 1 / z, 0];
  return columnMajor([shares, gridFromScene, secondFromFirst, first.sceneFromGrid].reduce(composed));
}
