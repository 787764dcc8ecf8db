/**
 * Views that are drawn for files: by the ray caster, while the screen waits, or by the engine, while it goes on.
 */
import type * as THREE from "three";
import type { Camera, Extent, Viewport } from "../../core/geometry/camera";
import type { RestingPicture } from "../../core/view/quality";
import { eyeCamera, eyesOf, viewportOf } from "../../core/view/stereo";
import type { GpuSupport } from "../base/gpu_support";
import type { EngineDrawing } from "../engine_pictures/engine_drawing";
import type { RayMarcher } from "../march/ray_marcher";
import type { Surfaces } from "../surfaces/surfaces";
import type { Compositor } from "./compositor";
import { EngineSnapshot, type AskSaved } from "./engine_snapshot";
import type { Refiner } from "./refiner";
import { Snapshot, type SnapshotWish } from "./snapshot";
import type { SnapshotTile } from "./snapshot_tile";
import type { ViewPane } from "./view_pane";

/** What draws. */
export interface Drawers {
  readonly renderer: THREE.WebGLRenderer;
  readonly marcher: RayMarcher;
  readonly surfaces: Surfaces;
  readonly compositor: Compositor;
  readonly refiner: Refiner;
  readonly pane: ViewPane;
  readonly engine: EngineDrawing;
  readonly support: GpuSupport;
  readonly askSaved: AskSaved;
  /** Takes ray caster and surfaces to a view, and returns its camera. */
  readonly aim: (camera: Camera, extent: Extent, aspect: number) => THREE.Camera;
  /** The screen must be drawn again. */
  readonly redraw: () => void;
}

/** Of the view on the screen. */
export interface SeenNow {
  readonly extent: Extent;
  readonly quality: RestingPicture;
}

/** Views to save; each is seen by a camera of its own. */
type Wish = Omit<SnapshotWish, "camera">;

export class PictureSaving {
  private drawing: "browser" | "engine" | null = null;
  private seen: THREE.Camera | null = null;

  constructor(private readonly by: Drawers) {}

  /** The screen waits: the ray caster draws for a file. */
  get holdsScreen(): boolean {
    return this.drawing === "browser";
  }

  /** Something is drawn for a file. */
  get isBusy(): boolean {
    return this.drawing !== null;
  }

  /**
   * Draws views by the ray caster into a canvas, one after another.
   *
   * @param taken waits until a view was taken from the canvas.
   */
  async byBrowser(
    context: CanvasRenderingContext2D,
    cameras: readonly Camera[],
    wish: Wish,
    now: SeenNow,
    taken: (view: number) => Promise<void>,
  ): Promise<void> {
    for (const [i, camera] of cameras.entries()) {
      await this.draw(context, { ...wish, camera }, now);
      await taken(i);
    }
  }

  /** Draws views by the engine, as `byBrowser` does: all of the scan as it is now. */
  async byEngine(
    context: CanvasRenderingContext2D,
    cameras: readonly Camera[],
    { size, transparent, marks, signal, progress }: Wish,
    { extent, quality: fineness }: SeenNow,
    taken: (view: number) => Promise<void>,
  ): Promise<void> {
    const { askSaved, compositor, engine, marcher, refiner, renderer, support } = this.by;
    const { look } = engine;
    if (look === null) {
      return;
    }
    const { width, height } = refiner.pictureOf(0).target;
    const snapshot = new EngineSnapshot(
      renderer,
      { marcher, compositor, halfFloat: support.halfFloatTarget },
      askSaved,
      (camera) => { this.aim(camera, extent, size); },
      this.overTile(marks === true),
    );
    const { jitter } = engine.pictures;
    this.drawing = "engine";
    try {
      await snapshot.draw(
        context,
        { look, cameras, size, shown: { width, height }, fineness, jitter, transparent, signal, progress },
        taken,
      );
    } finally {
      snapshot.dispose();
      this.drawing = null;
      // whoever draws on turns to its own view again
      refiner.restart();
    }
  }

  /** Draws a view by the ray caster into a canvas. */
  private async draw(
    context: CanvasRenderingContext2D,
    wish: SnapshotWish,
    { extent, quality }: SeenNow,
  ): Promise<void> {
    const { compositor, marcher, redraw, refiner, renderer, support, surfaces } = this.by;
    const { software, halfFloatTarget: halfFloat } = support;
    const { camera, size, stereo } = wish;
    const eyes = eyesOf(stereo, size);
    const viewport = viewportOf(stereo, size);
    const snapshot = new Snapshot(
      renderer,
      marcher,
      surfaces,
      compositor,
      { ...quality, software, halfFloat },
      (eye) => { this.aim(eyeCamera(camera, eyes[eye]?.aside ?? 0), extent, viewport); },
      this.overTile(wish.marks === true && stereo.mode === "off"),
    );
    this.drawing = "browser";
    try {
      await refiner.complete();
      await snapshot.draw(context, wish);
    } finally {
      snapshot.dispose();
      this.drawing = null;
      redraw();
      refiner.restart();
    }
  }

  private aim(camera: Camera, extent: Extent, { width, height }: Viewport): void {
    this.seen = this.by.aim(camera, extent, width / height);
  }

  /** What draws over a tile of the view that was aimed at. */
  private overTile(marks: boolean): (tile: SnapshotTile) => void {
    const { pane } = this.by;
    const { height } = pane.rect;
    return (tile) => {
      if (marks && this.seen !== null) {
        tile.over(this.seen, (camera, share) => {
          pane.drawMarks(camera, share * height);
        });
      }
    };
  }
}
