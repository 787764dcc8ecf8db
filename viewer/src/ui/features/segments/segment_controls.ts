/**
 * The controls that segments are worked on with.
 */
import type { InsideMode, InsideModes } from "../../../core/segments/shown_segments";
import type { BrushControl } from "./brush_control.svelte";
import type { CutControl } from "./cut_control.svelte";
import type { GrowControl } from "./grow_control.svelte";
import type { IslandsControl } from "./islands_control.svelte";
import type { ObjectControl } from "./object_control.svelte";
import type { ScissorsControl } from "./scissors_control.svelte";
import type { SegmentAppearanceControl } from "./segment_appearance_control";
import type { StatisticsControl } from "./statistics_control.svelte";
import type { SurfaceExport } from "./surface_export.svelte";
import type { ThresholdPreview } from "./threshold_preview.svelte";

export interface SegmentControls {
  /** The appearance of segments. */
  readonly segmentAppearance: SegmentAppearanceControl;
  /** The range of one while its slider is dragged. */
  readonly thresholdPreview: ThresholdPreview;
  /** Segments that are moved. */
  readonly objects: ObjectControl;
  /** A segment that is cut along a painted line. */
  readonly cutting: CutControl;
  /** What a loop on the picture cuts out. */
  readonly scissors: ScissorsControl;
  /** Segments that are found in the scan. */
  readonly growing: GrowControl;
  /** Islands of a segment that are to go. */
  readonly islands: IslandsControl;
  /** The brush in slices. */
  readonly brush: BrushControl;
  /** The numbers of all segments. */
  readonly statistics: StatisticsControl;
  /** Surfaces as files, and what they keep of the voxels. */
  readonly surfaces: SurfaceExport;
}

/** How the voxels of each segment look inside the volume. */
export interface InsideControl {
  readonly inside: InsideModes;
  readonly setInside: (id: number, mode: InsideMode) => void;
}
