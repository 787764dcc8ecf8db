/**
 * What page and volume worker say to each other.
 */
import type { BrickRanges } from "../core/bricks";
import type { Vec3 } from "../core/vector";
import type { LabelVolume } from "../core/voxel_change";

export interface VolumeRequest {
  /** The scan's values, or the segment of each voxel. */
  readonly kind: "values" | "labels";
  readonly url: string;
  /** Voxels along x, y, z that the answer must hold. */
  readonly dimensions: Vec3;
}

export type VolumeAnswer =
  | { readonly kind: "progress"; readonly share: number }
  | { readonly kind: "values"; readonly values: Uint16Array; readonly bricks: BrickRanges }
  | { readonly kind: "labels"; readonly labels: LabelVolume }
  | { readonly kind: "failed"; readonly text: string };
