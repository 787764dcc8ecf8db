/**
 * Draws a view as a picture of any size, tile by tile, so that neither the GPU's textures nor the time
 * of a frame limits it, for one eye or for two. Nothing in it is random, and steps and passes go by the quality alone:
 * what a GPU draws differs from what a CPU draws only by its rounding and by the cells in which light is worked out.
 */
import type * as THREE from "three";
import type { Camera, Viewport } from "../../core/geometry/camera";
import { halton } from "../../core/view/halton";
import { tilesOf, type Tile } from "../../core/view/image_size";
import type { Rect } from "../../core/view/picture_layout";
import type { RestingPicture } from "../../core/view/quality";
import { eyesOf, type Stereo } from "../../core/view/stereo";
import { Anaglyph } from "./anaglyph";
import type { Compositor } from "./compositor";
import { GpuClock } from "../base/gpu_clock";
import type { RayMarcher, Shift } from "../march/ray_marcher";
import { SnapshotTile } from "./snapshot_tile";
import { mostLayers } from "../textures/surface_layers";
import type { Surfaces } from "../surfaces/surfaces";

export interface SnapshotWish {
  /** As seen from between the eyes. */
  readonly camera: Camera;
  /** Whether it is a picture for each eye, and where they go. */
  readonly stereo: Stereo;
  /** Of the whole picture [pixels]. */
  readonly size: Viewport;
  /** Without the page's background. */
  readonly transparent: boolean;
  /** Lines and points of marks are a part of it; not of two eyes' pictures. */
  readonly marks?: boolean;
  readonly signal: AbortSignal;
  /** Told the share that is done, 0..1. */
  readonly progress?: (share: number) => void;
}

/** A tile of what one eye sees, or two whose pictures are mixed. */
interface Part {
  readonly tile: Tile;
  readonly eyes: readonly number[];
  /** Where their whole picture goes [pixels from the upper left]. */
  readonly rect: Rect;
}

/** How fine a picture is, and what draws it. */
interface SnapshotQuality extends RestingPicture {
  readonly software: boolean;
  /** Without it an average would be one of rounded bytes: there is one pass then. */
  readonly halfFloat: boolean;
}

/** Edge of a tile [pixels]: the page stays fluent between tiles. No pixel depends on it. */
const tileEdge = { gpu: 512, software: 192 } as const;

/** Layers of the light volume that are worked out at once. */
const lightLayers = 8;

export class Snapshot {
  private readonly tile: SnapshotTile;
  private readonly anaglyph = new Anaglyph();
  private readonly clock: GpuClock;

  /**
   * @param aim turns ray caster and surfaces to what an eye sees.
   * @param over draws over a tile of a single picture.
   */
  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly marcher: RayMarcher,
    private readonly surfaces: Surfaces,
    compositor: Compositor,
    private readonly quality: SnapshotQuality,
    private readonly aim: (eye: number) => void,
    private readonly over: (tile: SnapshotTile) => void,
  ) {
    this.tile = new SnapshotTile(renderer, compositor, quality.halfFloat);
    this.clock = new GpuClock(renderer.getContext() as WebGL2RenderingContext);
  }

  /**
   * Draws the view of the ray caster and of the surfaces into a canvas of that size.
   *
   * @throws the signal's reason where it is aborted.
   */
  async draw(context: CanvasRenderingContext2D, wish: SnapshotWish): Promise<void> {
    const { signal, progress } = wish;
    const parts = partsOf(wish, this.quality.software ? tileEdge.software : tileEdge.gpu);
    this.aim(0);
    while (this.marcher.light.pending) {
      signal.throwIfAborted();
      this.marcher.light.advance(this.renderer, lightLayers);
      await new Promise((resolve) => setTimeout(resolve));
    }
    for (const [i, part] of parts.entries()) {
      signal.throwIfAborted();
      await this.drawPart(part, wish);
      const { tile, rect } = part;
      context.putImageData(this.tile.read(), rect.x + tile.x, rect.y + rect.height - tile.y - tile.height);
      progress?.((i + 1) / parts.length);
    }
    signal.throwIfAborted();
  }

  dispose(): void {
    this.clock.forget();
    this.tile.dispose();
    this.anaglyph.dispose();
  }

  private async drawPart({ tile, eyes, rect }: Part, { signal, transparent }: SnapshotWish): Promise<void> {
    const { anaglyph, renderer } = this;
    this.tile.begin(tile, rect);
    if (eyes.length > 1) {
      anaglyph.resize(tile.width, tile.height);
    }
    for (const eye of eyes) {
      this.aim(eye);
      await this.drawTile(signal);
      this.tile.compose(transparent, eyes.length > 1 ? anaglyph.eyes[eye === 0 ? 0 : 1] : this.tile.shown);
    }
    if (eyes.length > 1) {
      anaglyph.draw(renderer, [0, 0], this.tile.shown);
    } else {
      this.over(this.tile);
    }
  }

  /** @throws the signal's reason where it is aborted. */
  private async drawTile(signal: AbortSignal): Promise<void> {
    const { halfFloat, passes, software, stepsPerVoxel } = this.quality;
    const averaged = halfFloat ? passes : 1;
    const { marcher, renderer, surfaces } = this;
    const { drawn } = this.tile;
    for (let count = 1; count <= averaged; ++count) {
      if (count > 1 && software) {
        // all passes at once would hold the page up
        await this.done(signal);
      }
      const shift: Shift = averaged === 1 ? [0, 0, 0] : [halton(count, 2) - 0.5, halton(count, 3) - 0.5, 0];
      surfaces.draw(renderer, drawn, { divisor: 1, stepsPerVoxel, shift, depth: mostLayers, detail: "all" });
      marcher.blend = count === 1 ? null : 1 / count;
      marcher.draw(renderer, drawn, { stepsPerVoxel, jitter: false }, shift);
      marcher.blend = null;
    }
    await this.done(signal);
  }

  /**
   * Waits, while the page stays fluent, until the GPU has drawn what it was given.
   *
   * @throws the signal's reason where it is aborted.
   */
  private async done(signal: AbortSignal): Promise<void> {
    await new Promise<void>((resolve) => {
      signal.addEventListener("abort", () => { resolve(); }, { once: true });
      this.clock.start(() => { resolve(); });
    });
    signal.throwIfAborted();
  }
}

/** Pictures that are mixed are drawn tile by tile, the others one after the other. */
function partsOf({ size, stereo }: SnapshotWish, edge: number): readonly Part[] {
  const eyes = eyesOf(stereo, size).map(({ rect }, eye) => ({ rect, eyes: [eye] }));
  const pictures = stereo.mode === "anaglyph" ? eyes.slice(0, 1).map(({ rect }) => ({ rect, eyes: [0, 1] })) : eyes;
  return pictures.flatMap((picture) => tilesOf(picture.rect, edge).map((tile) => ({ ...picture, tile })));
}
