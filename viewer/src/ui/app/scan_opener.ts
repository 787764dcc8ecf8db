/**
 * Opens a scan: the page's controls take it up, and the picture shows it, a large one coarsely first.
 */
import { looks } from "../../core/appearance/looks";
import { transformPoint } from "../../core/geometry/affine";
import { extentOf, type Camera } from "../../core/geometry/camera";
import type { Scan } from "../../core/protocol";
import type { BrickRanges } from "../../core/scan/bricks";
import { contentHull } from "../../core/scan/content_hull";
import { frameOf, type ScanVolume } from "../../core/scan/scan_volume";
import { biasedRange } from "../../core/scan/stored_values";
import type { ScanLoader } from "../features/scan/scan_loader.svelte";
import { needsLabels, type HeldScan, type ShownEdits } from "../features/scan/shown_edits.svelte";
import type { Session } from "../state/session.svelte";
import type { Controls } from "./controls";
import type { DrawnScene } from "./drawn_scene.svelte";
import type { PictureHost } from "./picture_host.svelte";

interface Outside extends Controls {
  readonly session: Session;
  readonly loader: ScanLoader;
  readonly edits: ShownEdits;
  readonly scene: DrawnScene;
  readonly picture: PictureHost;
}

export class ScanOpener {
  /** The view of a coarse picture, unless a person turns it. */
  private previewCamera: Camera | null = null;

  constructor(private readonly outside: Outside) {}

  /** Downloads a scan and shows it. */
  async open(scan: Scan): Promise<void> {
    const { appearance, brush, clips, edits, loader, marks, readout, slices, steps } = this.outside;
    const scanFrame = frameOf(scan);
    edits.clear();
    steps.clear();
    appearance.open(scan);
    clips.open(scanFrame);
    slices.open(scan);
    brush.open(scan);
    marks.open();
    readout.close();
    this.previewCamera = null;
    await loader.open(scan);
  }

  /** Shows a large scan coarsely while all of it is on its way; false where nothing can be shown yet. */
  preview(volume: ScanVolume, bricks: BrickRanges, scan: Scan): boolean {
    const { picture, scene, view } = this.outside;
    const { drawn } = picture;
    const { appearance } = scene;
    if (drawn === null || appearance === null) {
      return false;
    }
    this.measure(volume, bricks, scan);
    view.reset();
    this.previewCamera = view.camera;
    drawn.contents.setScan(volume, bricks);
    drawn.contents.setAppearance(appearance);
    picture.setSegments(scene.segments);
    return true;
  }

  /** Shows all of a scan. */
  show({ volume, bricks }: HeldScan, scan: Scan): void {
    const { picture, view } = this.outside;
    this.measure(volume, bricks, scan);
    if (this.previewCamera === null || view.camera === this.previewCamera) {
      view.reset();
    }
    picture.fill();
    this.showLabels();
  }

  /** Shows the segments that are no threshold, by the engine's latest labels. */
  showLabels(): void {
    const { edits, loader, picture, session } = this.outside;
    if (loader.held !== null) {
      const version = needsLabels(session.segments) ? session.labels : null;
      void edits.showLabels(version, loader.held.volume, () => picture.drawn);
    }
  }

  /** Finds where the body stands in the scan. */
  private measure(volume: ScanVolume, bricks: BrickRanges, scan: Scan): void {
    const air = scan.soft_tissue + looks.framing.air * (scan.bone - scan.soft_tissue);
    const [low, high] = biasedRange(air, Math.max(scan.range[1], air), volume.frame.rescale);
    const { frame: scanFrame, step } = volume;
    const hull = contentHull(bricks, step, scanFrame.spacing, (from, to) => from <= high && low <= to);
    this.outside.view.content = extentOf(hull.map((point) => transformPoint(scanFrame.sceneFromGrid, point)));
  }
}
