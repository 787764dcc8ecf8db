/**
 * Draws a view as a picture of any size, tile by tile, so that neither the GPU's textures nor the time
 * of a frame limits it. Nothing in it is random: the same view is the same picture on every machine.
 */
import * as THREE from "three";
import type { Camera, Viewport } from "../core/camera";
import { halton } from "../core/halton";
import { tilesOf, type Tile } from "../core/image_size";
import type { Compositor } from "./compositor";
import { PictureTarget } from "./picture_target";
import type { RayMarcher, Shift } from "./ray_marcher";
import { mostLayers } from "./surface_layers";
import type { Surfaces } from "./surfaces";

export interface SnapshotWish {
  readonly camera: Camera;
  /** Of the whole picture [pixels]. */
  readonly size: Viewport;
  /** Without the page's background. */
  readonly transparent: boolean;
  readonly signal: AbortSignal;
  /** Told the share that is done, 0..1. */
  readonly progress?: (share: number) => void;
}

/** Edge of a tile [pixels], pictures within a pixel that are averaged, steps per voxel edge. */
const quality = {
  gpu: { tile: 512, averaged: 8, stepsPerVoxel: 2 },
  software: { tile: 192, averaged: 1, stepsPerVoxel: 1 },
} as const;

/** Layers of the light volume that are worked out at once. */
const lightLayers = 8;

export class Snapshot {
  private readonly drawn: PictureTarget;
  private readonly shown = new THREE.WebGLRenderTarget(1, 1, { generateMipmaps: false });
  private readonly quality;

  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly marcher: RayMarcher,
    private readonly surfaces: Surfaces,
    private readonly compositor: Compositor,
    { software, halfFloat }: { readonly software: boolean; readonly halfFloat: boolean },
  ) {
    this.drawn = new PictureTarget(halfFloat);
    // without half floats an average would be one of rounded bytes
    this.quality = software || !halfFloat ? quality.software : quality.gpu;
  }

  /**
   * Draws the view of the ray caster and of the surfaces into a canvas of that size.
   *
   * @throws the signal's reason where it is aborted.
   */
  async draw(context: CanvasRenderingContext2D, wish: SnapshotWish): Promise<void> {
    const { signal, size, progress } = wish;
    const tiles = tilesOf(size, this.quality.tile);
    while (this.marcher.light.pending) {
      signal.throwIfAborted();
      this.marcher.light.advance(this.renderer, lightLayers);
      await new Promise((resolve) => setTimeout(resolve));
    }
    for (const [i, tile] of tiles.entries()) {
      signal.throwIfAborted();
      this.drawTile(tile, wish);
      context.putImageData(this.read(tile), tile.x, size.height - tile.y - tile.height);
      progress?.((i + 1) / tiles.length);
      // the page stays fluent
      await new Promise((resolve) => setTimeout(resolve));
    }
    signal.throwIfAborted();
  }

  dispose(): void {
    this.drawn.dispose();
    this.shown.dispose();
  }

  private drawTile(tile: Tile, { size, transparent }: SnapshotWish): void {
    const { averaged, stepsPerVoxel } = this.quality;
    const { drawn, marcher, renderer, surfaces } = this;
    if (drawn.target.width !== tile.width || drawn.target.height !== tile.height) {
      drawn.resize(tile.width, tile.height);
      this.shown.setSize(tile.width, tile.height);
    }
    drawn.tile = { ...size, x: tile.x, y: tile.y };
    drawn.useLevel(1);
    drawn.useRows(0, tile.height);
    for (let count = 1; count <= averaged; ++count) {
      const shift: Shift = averaged === 1 ? [0, 0, 0] : [halton(count, 2) - 0.5, halton(count, 3) - 0.5, 0];
      surfaces.draw(renderer, drawn, { divisor: 1, shift, depth: mostLayers });
      marcher.blend = count === 1 ? null : 1 / count;
      marcher.draw(renderer, drawn, { stepsPerVoxel, jitter: false }, shift);
    }
    marcher.blend = null;
    this.compositor.draw(renderer, drawn, { into: this.shown, corner: [0, 0], transparent });
  }

  /** The tile as a canvas takes it: rows from the top, colours not multiplied by opacity. */
  private read({ width, height }: Tile): ImageData {
    const bytes = new Uint8Array(4 * width * height);
    this.renderer.readRenderTargetPixels(this.shown, 0, 0, width, height, bytes);
    const image = new ImageData(width, height);
    for (let y = 0; y < height; ++y) {
      image.data.set(bytes.subarray(4 * width * (height - 1 - y), 4 * width * (height - y)), 4 * width * y);
    }
    return image;
  }
}
