/**
 * What a picture shows: scan and segments, surfaces, marks, and how they look. Each change has drawn anew what it
 * changes, whoever draws.
 */
import type * as THREE from "three";
import type { Appearance } from "../../core/appearance/appearance";
import { isGrey } from "../../core/appearance/optics";
import type { MovedPose, Segment } from "../../core/protocol";
import type { BrickRanges } from "../../core/scan/bricks";
import type { Displacements } from "../../core/scan/displacements";
import type { ScanVolume } from "../../core/scan/scan_volume";
import type { Box, LabelVolume } from "../../core/scan/voxel_change";
import type { CutSheet } from "../../core/segments/cut_sheet";
import { drawnFromVoxels, type InsideModes } from "../../core/segments/shown_segments";
import type { SurfaceChange } from "../../core/surfaces/surface_patches";
import type { Plane } from "../../core/view/clip";
import type { Vec3 } from "../../core/geometry/vector";
import type { EngineDrawing } from "../engine_pictures/engine_drawing";
import type { RayMarcher } from "../march/ray_marcher";
import type { MarkerState } from "../markers/markers";
import type { Surfaces } from "../surfaces/surfaces";
import type { DrawnScan } from "../textures/drawn_scan";
import { LabelTexture } from "../textures/label_texture";
import { labelColours } from "../textures/lookup_textures";
import { sameInView, type ShownSecond } from "../textures/second_texture";
import type { Compositor } from "./compositor";
import type { Refiner } from "./refiner";
import type { ShownSlice, SliceAppearance, Slices } from "./slices";
import type { ViewPane } from "./view_pane";

/** What draws the contents. */
export interface PictureParts {
  readonly renderer: THREE.WebGLRenderer;
  readonly marcher: RayMarcher;
  readonly surfaces: Surfaces;
  readonly compositor: Compositor;
  readonly slices: Slices;
  readonly scan: DrawnScan;
  readonly refiner: Refiner;
  readonly engine: EngineDrawing;
  readonly pane: ViewPane;
  /** Whether the engine draws, and not the ray caster. */
  readonly drawnByEngine: () => boolean;
  /** Is told that other slices are shown. */
  readonly slicesChanged: () => void;
}

export class PictureContents {
  private deforming = false;
  private labels: LabelTexture | null = null;
  private second: ShownSecond | null = null;
  private colours: THREE.DataTexture | null = null;

  constructor(private readonly parts: PictureParts) {}

  /**
   * Shows a scan. One that is drawn already, more coarsely or in part, is drawn so until these values are on the GPU.
   */
  setScan(volume: ScanVolume, bricks: BrickRanges): void {
    if (volume.frame === this.parts.scan.frame) {
      this.parts.scan.bring(volume, bricks, volume.dimensions[2]);
      return;
    }
    const field = this.parts.scan.begin(volume);
    this.parts.refiner.recount();
    this.parts.engine.pictures.recount();
    this.parts.marcher.setField(field, bricks);
    this.parts.slices.follow(volume.frame);
    this.parts.surfaces.setFrame(volume.frame);
    this.parts.refiner.restart();
  }

  /**
   * Shows more finely what is drawn of a scan; nothing else is drawn by that.
   *
   * @param volume the same object each time, with more values.
   * @param bricks ranges that cover all of them.
   * @param arrived planes, from the first on, that have their own values; what stands in for others does not change.
   */
  refineScan(volume: ScanVolume, bricks: BrickRanges, arrived: number): void {
    if (volume.frame === this.parts.scan.frame) {
      this.parts.scan.bring(volume, bricks, arrived);
    }
  }

  setAppearance(appearance: Appearance): void {
    this.parts.marcher.setAppearance(appearance);
    this.parts.engine.setAppearance(appearance);
    this.parts.compositor.bendsHighlights = !isGrey(appearance.optics.blend);
    this.parts.refiner.restart();
  }

  /** Segments that are no threshold; null where there are none. */
  setLabels(volume: LabelVolume | null): void {
    const isFirst = this.labels === null;
    this.labels?.dispose();
    this.labels = volume === null ? null : new LabelTexture(volume);
    this.parts.marcher.setLabels(
      volume === null || this.labels === null ? null : { texture: this.labels.texture, bricks: volume.bricks },
    );
    this.parts.slices.follow(this.parts.scan.frame);
    if (isFirst) {
      // they come with an edit that is seen already, and show the same as thresholds did
      this.parts.refiner.renew();
    } else {
      this.parts.refiner.restart();
    }
  }

  /** Shows a second scan with the first, or shows it in another way or elsewhere; null shows none. */
  setSecond(shown: ShownSecond | null): void {
    this.parts.marcher.setSecond(shown);
    this.parts.engine.setSecond(shown?.appearance ?? null);
    this.parts.slices.follow(this.parts.scan.frame);
    if (!sameInView(shown, this.second)) {
      this.parts.refiner.restart();
    }
    this.second = shown;
  }

  /** How segments are shown, from their voxels and as surfaces. */
  setSegments(segments: readonly Segment[], modes: InsideModes = {}): void {
    this.colours?.dispose();
    this.colours = labelColours(segments, drawnFromVoxels, modes);
    this.parts.marcher.setLabelColours(this.colours);
    this.parts.surfaces.setSegments(segments, modes);
    this.parts.slices.setSegments(segments);
    this.parts.engine.setSegments({ segments, modes });
    this.parts.refiner.restart();
  }

  /** Values, labels or both have changed in a box of the arrays that this picture was given. */
  changeVoxels(box: Box, what: { readonly values: boolean; readonly labels: boolean }): void {
    if (what.values) {
      this.parts.scan.uploadBox(this.parts.renderer, box);
    }
    if (what.labels) {
      this.labels?.uploadBox(this.parts.renderer, box);
    }
    if (this.parts.drawnByEngine()) {
      // it draws its own voxels, whatever has come here of the scan
      this.parts.refiner.restart();
    }
    if (this.parts.scan.isLoading) {
      // it is drawn with the scan that comes
      return;
    }
    this.parts.marcher.changeVoxels(box, this.parts.renderer);
    this.parts.slices.changed();
    const region = this.parts.pane.regionOf(this.parts.marcher.cornersOf(box));
    if (region === null || this.deforming || this.parts.drawnByEngine()) {
      this.parts.refiner.restart();
    } else {
      this.parts.refiner.change(region);
    }
  }

  /** Exchanges patches of surfaces. */
  changeSurfaces(changes: readonly SurfaceChange[]): void {
    this.parts.surfaces.apply(this.parts.renderer, changes);
    this.parts.refiner.restart();
  }

  /** Whether a model of deformation is at work: only then tissue can be displaced. */
  setDeforming(on: boolean): void {
    if (on !== this.deforming) {
      this.deforming = on;
      // between two pictures tissue moves, and not as the view does
      this.parts.engine.mayTurn = !on;
      this.parts.marcher.setDeforming(on);
      this.parts.slices.follow(this.parts.scan.frame);
      this.parts.refiner.restart();
    }
  }

  /** Displacements of tissue from its voxels, which add up; none where all stands in them. */
  setDisplaced(displaced: readonly Displacements[]): void {
    this.parts.marcher.setDisplaced(displaced);
    this.parts.slices.changed();
    this.parts.refiner.restart();
  }

  /** Where moved segments stand now. */
  setPoses(poses: readonly MovedPose[]): void {
    if (this.parts.surfaces.setPoses(poses)) {
      this.parts.refiner.restart();
    }
  }

  /** Cuts away what lies before planes of the scene. */
  setClip(planes: readonly Plane[]): void {
    this.parts.marcher.setClip(planes);
    this.parts.surfaces.setClip(planes);
    this.parts.engine.setClip(planes);
    this.parts.refiner.restart();
  }

  /** Points of each mark that is shown, in their order; scene [mm]. */
  setMarks(lines: readonly (readonly Vec3[])[]): void {
    this.parts.pane.setMarks(lines);
  }

  /** The surface that a cut would go along; null where nothing is cut. */
  setCutSheet(sheet: CutSheet | null): void {
    this.parts.pane.setCutSheet(sheet);
  }

  setMarkers(state: MarkerState): void {
    this.parts.pane.setMarkers(state);
  }

  /** Which slices are seen beside the 3-D view. */
  setSlices(shown: readonly ShownSlice[]): void {
    if (this.parts.slices.show(shown)) {
      this.parts.slicesChanged();
    }
  }

  setSliceAppearance(appearance: SliceAppearance): void {
    this.parts.slices.setAppearance(appearance);
  }

  dispose(): void {
    this.labels?.dispose();
    this.colours?.dispose();
  }
}
