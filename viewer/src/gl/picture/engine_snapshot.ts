/**
 * Pictures for files that the engine draws: strips, which are put together and over the ground by the browser.
 */
import type * as THREE from "three";
import type { Camera, Viewport } from "../../core/geometry/camera";
import type { DrawnPicture, PictureLook } from "../../core/protocol";
import { tilesOf } from "../../core/view/image_size";
import type { RestingPicture } from "../../core/view/quality";
import { fewestSamples, savedSamples, type PictureWish } from "../../core/view/saved_pictures";
import { EnginePass } from "../engine_pictures/engine_pass";
import { seenFrom } from "../engine_pictures/engine_pictures";
import { rawTexels } from "../engine_pictures/picture_texels";
import type { RayMarcher } from "../march/ray_marcher";
import type { Compositor } from "./compositor";
import { SnapshotTile } from "./snapshot_tile";

/** Rows of a strip that the GPU is given at once. */
const mostRows = 2048;

/** Asks the engine for pictures, which come as strips from the left to the right. */
export type AskSaved = (wish: PictureWish, signal: AbortSignal) => AsyncIterable<DrawnPicture>;

export interface EngineSnapshotWish {
  readonly look: PictureLook;
  /** From where each picture is seen. */
  readonly cameras: readonly Camera[];
  /** Of a whole picture, and of the view on the screen [pixels]. */
  readonly size: Viewport;
  readonly shown: Viewport;
  readonly fineness: RestingPicture;
  /** Rays start at random shares of a step. */
  readonly jitter: boolean;
  /** Without the page's background. */
  readonly transparent: boolean;
  readonly signal: AbortSignal;
  /** Told the share that is done, 0..1. */
  readonly progress?: ((share: number) => void) | undefined;
}

/** What puts strips together. */
interface Drawing {
  readonly marcher: RayMarcher;
  readonly compositor: Compositor;
  readonly halfFloat: boolean;
}

export class EngineSnapshot {
  private readonly tile: SnapshotTile;
  private readonly pass: EnginePass;

  /**
   * @param aim turns markers to what is seen by a camera.
   * @param over draws over a tile.
   */
  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly drawing: Drawing,
    private readonly ask: AskSaved,
    private readonly aim: (camera: Camera) => void,
    private readonly over: (tile: SnapshotTile) => void,
  ) {
    this.tile = new SnapshotTile(renderer, drawing.compositor, drawing.halfFloat);
    this.pass = new EnginePass(drawing.marcher);
  }

  /**
   * Draws pictures as their strips come into a canvas of their size, one after another.
   *
   * @param taken waits until a picture was taken from the canvas; then the next one is drawn over it.
   * @throws the signal's reason where it is aborted.
   */
  async draw(
    context: CanvasRenderingContext2D,
    wish: EngineSnapshotWish,
    taken: (picture: number) => Promise<void>,
  ): Promise<void> {
    const { cameras, signal, size } = wish;
    const bends = this.drawing.compositor.bendsHighlights;
    let [done, x] = [0, 0];
    for await (const strip of this.ask(asked(wish), signal)) {
      signal.throwIfAborted();
      const camera = cameras[done];
      if (camera === undefined || strip.number !== done || strip.size[1] !== size.height) {
        throw new Error("the engine sent another picture than was requested");
      }
      this.drawStrip(context, strip, { camera, x, bends, wish });
      x += strip.size[0];
      wish.progress?.((done + x / size.width) / cameras.length);
      if (x >= size.width) {
        await taken(done);
        [done, x] = [done + 1, 0];
      }
      // the page stays fluent, however quickly strips come
      await new Promise((resolve) => setTimeout(resolve));
    }
    signal.throwIfAborted();
    if (done < cameras.length) {
      throw new Error("the engine stopped before the picture was whole");
    }
  }

  dispose(): void {
    this.tile.dispose();
    this.pass.dispose();
  }

  private drawStrip(
    context: CanvasRenderingContext2D,
    strip: DrawnPicture,
    { camera, x, bends, wish }: {
      readonly camera: Camera;
      readonly x: number;
      readonly bends: boolean;
      readonly wish: EngineSnapshotWish;
    },
  ): void {
    const { pass, renderer, tile } = this;
    const { compositor } = this.drawing;
    const { size, transparent } = wish;
    const [width, height] = strip.size;
    const bentNow = compositor.bendsHighlights;
    compositor.bendsHighlights = bends;
    this.aim(camera);
    for (const rows of tilesOf({ width, height }, mostRows)) {
      tile.begin({ ...rows, x: x + rows.x }, size);
      pass.take(rawTexels(rowsOf(strip, height - rows.y - rows.height, rows.height)));
      pass.draw(renderer, tile.drawn);
      tile.compose(transparent);
      this.over(tile);
      context.putImageData(tile.read(), x + rows.x, height - rows.y - rows.height);
    }
    compositor.bendsHighlights = bentNow;
    renderer.setRenderTarget(null);
  }
}

function asked({ look, cameras, fineness, jitter, shown, size }: EngineSnapshotWish): PictureWish {
  const samples = savedSamples(fineness.passes, size, shown);
  return {
    look,
    cameras: cameras.map(seenFrom),
    size: [size.width, size.height],
    steps_per_voxel: fineness.stepsPerVoxel,
    samples,
    // of few rays for each pixel the noise would be seen
    jitter: jitter && samples >= fewestSamples,
  };
}

/** Some rows of a strip, from the upper edge. */
function rowsOf(strip: DrawnPicture, first: number, rows: number): DrawnPicture {
  const [width, height] = strip.size;
  const part = (bytes: Uint8Array): Uint8Array => {
    const row = bytes.length / height;
    return bytes.subarray(first * row, (first + rows) * row);
  };
  return { ...strip, size: [width, rows], colours: part(strip.colours), depths: part(strip.depths) };
}
