/**
 * Everything but the camera that decides how the scan is drawn.
 */
import { looks } from "./looks";
import type { Optics } from "./optics";
import type { ShownRange } from "../segments/shown_segments";
import type { TransferFunction } from "./transfer_function";

/** Factors on the light of the picture; 1 is as it is lit first. Source: Blinn, SIGGRAPH (1977). */
export interface Lighting {
  readonly ambient: number;
  readonly diffuse: number;
  readonly specular: number;
  /** On the exponent of highlights: more is a smaller one. */
  readonly shininess: number;
  /** Share of its extinction that flat tissue loses, away from any boundary. */
  readonly edges: number;
  /** How much of the light is seen that what is drawn keeps from other places, 0..1: of sky, and of the lamp. */
  readonly occlusion: number;
  readonly shadow: number;
}

export interface Appearance {
  readonly transferFunction: TransferFunction;
  readonly ranges: readonly ShownRange[];
  /** Gradient [value per mm] from which on a tissue boundary is drawn at full strength. */
  readonly edgeGradient: number;
  readonly lighting: Lighting;
  /** How values along a ray become one colour. */
  readonly optics: Optics;
}

/** Share of its extinction that flat tissue keeps, away from any boundary. */
export const flatShare = 1 - looks.lighting.edges;

export const firstLighting: Lighting = looks.lighting;

/** What of an appearance tells how opaque places are; other light is no reason to work that out again. */
export function opacityKey({ transferFunction, ranges, edgeGradient, lighting, optics }: Appearance): string {
  return JSON.stringify([transferFunction, ranges, edgeGradient, lighting.edges, optics]);
}

/** Factor on the extinction: boundaries stay, flat tissue becomes clear (Levoy 1988). */
export function edgeFactor(gradient: number, edgeGradient: number, edges = 1 - flatShare): number {
  const x = Math.min(1, Math.max(0, gradient / edgeGradient));
  return 1 - edges + edges * x * x * (3 - 2 * x);
}
