/**
 * What stands on the canvas: the pane of the 3-D view, and slices beside it. Where the screen keeps what was drawn,
 * only what has changed is drawn again.
 */
import type * as THREE from "three";
import type { Viewport } from "../../core/geometry/camera";
import type { Rect } from "../../core/view/picture_layout";
import type { Vec3 } from "../../core/geometry/vector";
import { everywhere, type Region } from "../../core/view/region";
import type { Slices } from "./slices";
import type { ViewPane } from "./view_pane";

/**
 * By how much the screen divides its own pixels while it shows a coarse picture and the CPU draws: to enlarge that to
 * all of them takes as long as to draw it, and browsers do it in less time.
 */
const fewer = 2;

export class DrawnScreen {
  /** All of it is to be drawn again. */
  stale = true;
  /** What was drawn last, by identity: the same as long as nothing but markers is drawn again. */
  drawing = Symbol();
  /** The whole canvas [CSS pixels]. */
  private canvas: Viewport = { width: 1, height: 1 };
  /** Device pixels per CSS pixel at rest. */
  private pixelRatio = 1;

  /**
   * @param keeps whether what is not drawn again stays; where the CPU draws.
   * @param mostPixelRatio device pixels per CSS pixel, at most.
   */
  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly pane: ViewPane,
    private readonly slices: Slices,
    private readonly keeps: boolean,
    private readonly mostPixelRatio: number,
  ) {}

  /**
   * Follows the size of the canvas on the page and the place of the 3-D view on it [CSS pixels].
   *
   * @returns device pixels per CSS pixel.
   */
  resize(canvas: Viewport, pane: Rect): number {
    const { renderer } = this;
    const { width, height } = canvas;
    const ratio = Math.min(window.devicePixelRatio, this.mostPixelRatio);
    if (width !== this.canvas.width || height !== this.canvas.height || ratio !== renderer.getPixelRatio()) {
      this.pixelRatio = ratio;
      renderer.setPixelRatio(ratio);
      renderer.setSize(width, height, false);
    }
    this.canvas = canvas;
    this.pane.rect = pane;
    this.pane.canvasHeight = height;
    this.stale = true;
    return ratio;
  }

  /** Where the CPU draws, gives the screen fewer pixels while it shows nothing but a coarse picture. */
  fit(): void {
    const { pane, pixelRatio, renderer } = this;
    const isFew = this.keeps && this.slices.isEmpty && pane.stereo.mode === "off" && pane.isCoarse;
    const ratio = isFew ? pixelRatio / fewer : pixelRatio;
    if (ratio !== renderer.getPixelRatio()) {
      renderer.setPixelRatio(ratio);
      this.stale = true;
    }
  }

  /** Draws the picture of the scan alone. */
  drawPicture(): void {
    this.clear();
    this.pane.drawPicture();
  }

  /**
   * Draws what has changed.
   *
   * @param changed where the picture has changed; null where nowhere.
   * @param outline tells points around all that is drawn of the scan [scene, mm]; null where that may be anywhere.
   */
  draw(changed: Region | null, outline: () => readonly Vec3[] | null): void {
    const { keeps, pane, slices, stale } = this;
    if (stale || changed !== null || slices.isStale) {
      this.drawing = Symbol();
    }
    if (changed === everywhere || stale || (slices.isStale && !keeps)) {
      this.drawSlices();
      pane.draw(stale || !keeps ? null : outline());
    } else {
      if (slices.isStale) {
        this.drawSlices();
      }
      if (pane.stale || changed !== null) {
        this.drawMarkers(changed);
      }
    }
    this.stale = false;
  }

  /** Draws slices: those that have changed, or all where the screen forgets. */
  private drawSlices(): void {
    if (this.stale) {
      this.clear();
    }
    this.slices.draw(this.renderer, this.canvas.height, this.renderer.getPixelRatio(), this.stale || !this.keeps);
  }

  /** Draws again where markers were and are, and a region of the picture. */
  private drawMarkers(region: Region | null): void {
    if (!this.keeps) {
      this.drawSlices();
    }
    this.pane.drawMarkers(this.keeps, region);
  }

  private clear(): void {
    this.renderer.setRenderTarget(null);
    this.renderer.clear();
  }
}
