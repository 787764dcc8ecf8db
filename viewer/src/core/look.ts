/**
 * Everything but the camera that decides how the scan is drawn.
 */
import type { Optics } from "./optics";
import type { ShownRange } from "./shown_segments";
import type { TransferFunction } from "./transfer_function";

export interface Look {
  readonly transferFunction: TransferFunction;
  readonly ranges: readonly ShownRange[];
  /** Gradient [value per mm] from which on a tissue boundary is drawn at full strength. */
  readonly edgeGradient: number;
  /** How values along a ray become one colour. */
  readonly optics: Optics;
}

/** Share of its extinction that flat tissue keeps, away from any boundary. */
export const flatShare = 0.06;

/** Factor on the extinction: boundaries stay, flat tissue becomes clear (Levoy 1988). */
export function edgeFactor(gradient: number, edgeGradient: number): number {
  const x = Math.min(1, Math.max(0, gradient / edgeGradient));
  return flatShare + (1 - flatShare) * x * x * (3 - 2 * x);
}
