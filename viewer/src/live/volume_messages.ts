/**
 * What page and volume worker say to each other.
 */
import type { Arrival, Planes } from "../core/scan/loading_scan";
import type { BrickRanges } from "../core/scan/bricks";
import type { CoarseScan } from "../core/scan/plane_interpolation";
import type { Vec3 } from "../core/geometry/vector";
import type { LabelVolume } from "../core/scan/voxel_change";

/** The segment of each voxel. */
export interface LabelsRequest {
  readonly kind: "labels";
  readonly url: string;
  /** Voxels along x, y, z that the answer must hold. */
  readonly dimensions: Vec3;
}

/** The scan's values. */
export interface ValuesRequest {
  readonly kind: "values";
  readonly url: string;
  readonly dimensions: Vec3;
  /** Every how many voxels along each axis a value is asked for. */
  readonly step: number;
  /** What stands in for values on their way is made from a coarse scan; null where nothing does. */
  readonly meanwhile: (ShownParts & { readonly coarse: CoarseScan }) | null;
}

/** How a scan is shown while it arrives. */
export interface ShownParts {
  /** How often, at most. */
  readonly parts: number;
  /** Not at all where the rest is expected sooner than this [ms]. */
  readonly soon: number;
}

export type VolumeRequest = LabelsRequest | ValuesRequest;

export type VolumeAnswer =
  | { readonly kind: "progress"; readonly share: number }
  /** Some planes: their own, or what stands in for them. */
  | { readonly kind: "planes"; readonly planes: Planes }
  /** All planes have been sent, in part by what stands in for them. */
  | { readonly kind: "arrival"; readonly arrival: Arrival }
  /** All planes have been sent. */
  | { readonly kind: "values"; readonly bricks: BrickRanges }
  | { readonly kind: "labels"; readonly labels: LabelVolume }
  | { readonly kind: "failed"; readonly text: string };
