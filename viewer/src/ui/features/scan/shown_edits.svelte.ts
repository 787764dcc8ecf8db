/**
 * Edits on their way to the picture. All that one edit changes, voxels, labels and surfaces,
 * is taken at once, between two frames; an edit that is not whole is not taken at all.
 */
import type { Changed, Segment } from "../../../core/protocol";
import { decodeDisplacements, type Displacements } from "../../../core/scan/displacements";
import type { ScanVolume } from "../../../core/scan/scan_volume";
import type { BrickRanges } from "../../../core/scan/bricks";
import {
  decodeSurface,
  SurfacePatches,
  type Patch,
  type SurfaceChange,
  type SurfaceSize,
} from "../../../core/surfaces/surface_patches";
import type { Vec3 } from "../../../core/geometry/vector";
import {
  decodeVoxels,
  labelAtPoint,
  updateBricks,
  updateLabels,
  writeBox,
  type LabelVolume,
  type VoxelChange,
} from "../../../core/scan/voxel_change";
import type { Picture } from "../../../gl/picture/picture";

/** What an edit took on its way [ms]. */
export interface EditTimes {
  /** Its number; of several at once the last one's. */
  readonly edit: number;
  /** When the engine applied it [ms since 1970]; of several at once the oldest. */
  readonly applied: number;
  /** From when the engine applied it, by the clock of its machine, until it arrived. */
  readonly way: number;
  /** Until the page got to it: a frame was drawn meanwhile. */
  readonly wait: number;
  /** Until all of it was uploaded to the GPU. */
  readonly work: number;
}

/** Times of edits that are kept. */
const mostTimes = 1000;

interface Waiting {
  readonly changed: Changed;
  /** As `performance.now()` tells time. */
  readonly arrived: number;
}

/** Everything an edit changes, read and found whole. */
interface Edit {
  /** In the order in which they hold. */
  readonly voxels: readonly VoxelChange[];
  readonly surfaces: readonly SurfaceChange[];
  /** Displacements of tissue then; null where they are as before. */
  readonly displaced: readonly Displacements[] | null;
}

/** The scan as the page holds it; edits change it in place. */
export interface HeldScan {
  readonly volume: ScanVolume;
  readonly bricks: BrickRanges;
}

/** What is asked of the rest of the page. */
export interface Outside {
  /** Tells the person at the page. */
  readonly complain: (text: string) => void;
  /** Fetches the segment of each voxel. */
  readonly download: (volume: ScanVolume) => Promise<LabelVolume>;
}

export class ShownEdits {
  private readonly surfaces = new SurfacePatches();
  /** Size of each surface that is there. */
  sizes = $state.raw<ReadonlyMap<number, SurfaceSize>>(this.surfaces.sizes);
  /** From the arrival of the last edit until all of it was uploaded to the GPU [ms]; null before the first. */
  lastMilliseconds: number | null = null;
  /** Of the last edits, the newest last. */
  readonly times: EditTimes[] = [];
  /** Number of the last edit on display; 0 before the first. */
  lastEdit = 0;

  /** The first labels are on their way: until they are here no segment can be shown by them. */
  awaitsLabels = $state(false);

  /** Displacements of tissue from its voxels, which add up; empty where there are none. */
  displaced: readonly Displacements[] = [];

  private waiting: Waiting[] = [];
  private labels: LabelVolume | null = null;
  /** Version of the labels that are here, or on their way. */
  private labelVersion: number | null = null;
  /** Whether any segment is seen by its labels; else they wait here until one is. */
  private drawsLabels = false;
  /** The labels that the picture has. */
  private drawn: LabelVolume | null = null;
  /** Changes of labels since newer ones were asked for; null where none are on their way. */
  private sinceAsked: VoxelChange[] | null = null;

  constructor(private readonly outside: Outside) {}

  /** Patches of a segment's surface, as they are on display. */
  patches(id: number): readonly Patch[] {
    return this.surfaces.patches(id);
  }

  /** Number of the segment that a point of the grid has as its label, seen or not; 0 for none. */
  labelAt(grid: Vec3, step: number): number {
    return this.labels === null ? 0 : labelAtPoint(this.labels, grid, step);
  }

  /** Takes an edit that has arrived. */
  add(changed: Changed, arrived: number): void {
    this.waiting.push({ changed, arrived });
  }

  /** Takes all edits that wait into what the page holds, and into the picture if there is one. */
  show(scan: HeldScan, picture: Picture | null): void {
    const edits = this.waiting;
    this.waiting = [];
    for (const { changed, arrived } of edits) {
      const began = performance.now();
      this.showOne(changed, scan, picture);
      const ended = performance.now();
      this.lastMilliseconds = ended - arrived;
      if (changed.applied !== null) {
        const ago = Date.now() - 1000 * changed.applied;
        this.times.push({
          edit: changed.edit,
          applied: 1000 * changed.applied,
          way: ago - (ended - arrived),
          wait: began - arrived,
          work: ended - began,
        });
        this.times.splice(0, this.times.length - mostTimes);
      }
    }
    if (edits.some(({ changed }) => changed.surfaces.length > 0)) {
      this.sizes = this.surfaces.sizes;
    }
  }

  /** Another scan: what was shown belongs to the one before. */
  clear(): void {
    this.surfaces.clear();
    this.displaced = [];
    this.sizes = this.surfaces.sizes;
    this.labels = null;
    this.labelVersion = null;
    this.drawsLabels = false;
    this.drawn = null;
    this.sinceAsked = null;
    this.awaitsLabels = false;
  }

  /** Gives all that is held to a new picture. */
  showAll(picture: Picture): void {
    this.drawn = this.drawsLabels ? this.labels : null;
    picture.contents.setLabels(this.drawn);
    picture.contents.setDisplaced(this.displaced);
    picture.contents.changeSurfaces(
      this.surfaces.ids.map((id) => ({ id, whole: true, dropped: [], patches: this.surfaces.patches(id) })),
    );
  }

  /**
   * Shows the labels of a version, downloaded where they are others than those that are here; null where no segment
   * needs any now. Edits that arrive meanwhile are kept.
   */
  async showLabels(version: number | null, volume: ScanVolume, picture: () => Picture | null): Promise<void> {
    this.drawsLabels = version !== null;
    this.passLabels(picture());
    if (version === null || version === this.labelVersion) {
      return;
    }
    this.labelVersion = version;
    this.sinceAsked = [];
    this.awaitsLabels = this.labels === null;
    const still = (): boolean => version === this.labelVersion;
    try {
      const labels = await this.outside.download(volume);
      if (still()) {
        this.takeLabels(labels, picture());
      }
    } catch (error) {
      if (still()) {
        this.labelVersion = null;
        this.sinceAsked = null;
        this.awaitsLabels = false;
        this.outside.complain(`The segments' voxels did not arrive: ${messageOf(error)}`);
      }
    }
  }

  private takeLabels(labels: LabelVolume, picture: Picture | null): void {
    for (const { box, labels: ids } of this.sinceAsked ?? []) {
      if (ids !== null) {
        updateLabels(labels, box, ids);
      }
    }
    this.sinceAsked = null;
    this.awaitsLabels = false;
    this.labels = labels;
    this.passLabels(picture);
  }

  private passLabels(picture: Picture | null): void {
    const labels = this.drawsLabels ? this.labels : null;
    if (picture !== null && labels !== this.drawn) {
      this.drawn = labels;
      picture.contents.setLabels(labels);
    }
  }

  private showOne(changed: Changed, scan: HeldScan, picture: Picture | null): void {
    let edit: Edit;
    try {
      const voxels = changed.voxels.map((box) => decodeVoxels(box, scan.volume));
      edit = {
        voxels: voxels.filter((change) => change !== null),
        surfaces: changed.surfaces.map(decodeSurface),
        displaced: changed.displaced?.map(decodeDisplacements) ?? null,
      };
    } catch (error) {
      this.outside.complain(`Edit ${String(changed.edit)} cannot be shown: ${messageOf(error)}.`);
      return;
    }
    for (const change of edit.voxels) {
      this.changeVoxels(change, scan, picture);
    }
    for (const change of edit.surfaces) {
      this.surfaces.apply(change);
    }
    if (edit.surfaces.length > 0) {
      picture?.contents.changeSurfaces(edit.surfaces);
    }
    if (edit.displaced !== null) {
      this.displaced = edit.displaced;
      picture?.contents.setDisplaced(edit.displaced);
    }
    this.lastEdit = changed.edit;
  }

  private changeVoxels(change: VoxelChange, { volume, bricks }: HeldScan, picture: Picture | null): void {
    const { box, values, labels } = change;
    if (values !== null) {
      writeBox(volume.values, volume.dimensions, box, values);
      updateBricks(bricks, volume, box);
    }
    if (labels !== null) {
      this.sinceAsked?.push(change);
      if (this.labels !== null) {
        updateLabels(this.labels, box, labels);
      }
    }
    // labels that are not here will come with this edit in them
    picture?.contents.changeVoxels(box, { values: values !== null, labels: labels !== null && this.labels !== null });
  }
}

/** Whether any segment that is seen has voxels of the scan that no threshold describes. */
export function needsLabels(segments: readonly Segment[]): boolean {
  return segments.some(({ visible, range, grid }) => visible && range === null && grid === null);
}

function messageOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
