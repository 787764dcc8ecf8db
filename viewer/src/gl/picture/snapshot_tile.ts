/** A tile of a picture for a file: drawn, put over its ground, and read back. */
import * as THREE from "three";
import type { Viewport } from "../../core/geometry/camera";
import type { Tile } from "../../core/view/image_size";
import { PictureTarget } from "../base/picture_target";
import { shifted } from "../surfaces/surfaces";
import type { Compositor } from "./compositor";

export class SnapshotTile {
  /** What is drawn, with its depth. */
  readonly drawn: PictureTarget;
  /** The same as it is seen (sRGB). */
  readonly shown = new THREE.WebGLRenderTarget(1, 1, { generateMipmaps: false });

  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly compositor: Compositor,
    halfFloat: boolean,
  ) {
    this.drawn = new PictureTarget(halfFloat);
  }

  /** Makes room for a tile of a whole picture [pixels]. */
  begin({ x, y, width, height }: Tile, whole: Viewport): void {
    const { drawn, shown } = this;
    if (drawn.target.width !== width || drawn.target.height !== height) {
      drawn.resize(width, height);
      shown.setSize(width, height);
    }
    drawn.tile = { width: whole.width, height: whole.height, x, y };
    drawn.useLevel(1);
    drawn.useRows(0, height);
  }

  /** Puts what was drawn over the page's ground, or over none. */
  compose(transparent: boolean, into = this.shown): void {
    const { compositor, drawn, renderer } = this;
    compositor.draw(renderer, drawn, {
      into,
      pane: { corner: [0, 0], size: [drawn.target.width, drawn.target.height] },
      transparent,
    });
  }

  /**
   * Draws over what was composed, hidden by its depth.
   *
   * @param camera of the whole picture.
   * @param draw is given the tile's camera, and which share of the whole picture's height the tile has.
   */
  over(camera: THREE.Camera, draw: (camera: THREE.Camera, share: number) => void): void {
    const { drawn, renderer, shown } = this;
    renderer.setRenderTarget(shown);
    draw(shifted(camera, drawn, [0, 0, 0]), drawn.height / (drawn.tile?.height ?? drawn.height));
  }

  /** The tile as a canvas takes it: rows from the top, colours not multiplied by opacity. */
  read(): ImageData {
    const { width, height } = this.shown;
    const bytes = new Uint8Array(4 * width * height);
    this.renderer.readRenderTargetPixels(this.shown, 0, 0, width, height, bytes);
    const image = new ImageData(width, height);
    for (let y = 0; y < height; ++y) {
      image.data.set(bytes.subarray(4 * width * (height - 1 - y), 4 * width * (height - y)), 4 * width * y);
    }
    return image;
  }

  dispose(): void {
    this.drawn.dispose();
    this.shown.dispose();
  }
}
