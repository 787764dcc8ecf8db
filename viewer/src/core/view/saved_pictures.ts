/**
 * Pictures for files that the engine draws: what is asked for, and the parts in which they arrive.
 */
import { decodeToPage, type DrawnPicture, type DrawPicture, type PictureLook } from "../protocol";
import type { Viewport } from "../geometry/camera";

/** Pictures of one look and size, from each camera. */
export interface PictureWish {
  readonly look: PictureLook;
  readonly cameras: DrawPicture["cameras"];
  /** Columns and rows. */
  readonly size: readonly [number, number];
  readonly steps_per_voxel: number;
  /** Rays for each pixel. */
  readonly samples: number;
  readonly jitter: boolean;
}

/** Rays for each pixel of the screen at least where the engine draws: each takes it a moment only. */
export const fewestSamples = 4;

/**
 * Rays for each pixel of a picture that is saved: in sum as many for each pixel of the screen as the quality says.
 *
 * @param shown the view on the screen [pixels].
 */
export function savedSamples(passes: number, size: Viewport, shown: Viewport): number {
  const finer = (size.width * size.height) / Math.max(1, shown.width * shown.height);
  return Math.ceil(Math.max(fewestSamples, passes) / Math.max(1, finer));
}

/** Bytes of the length before each part. */
const prefix = 4;

/** Puts together what arrives in pieces: strips of pictures, each after its length [bytes, uint32, little-endian]. */
export class Strips {
  private pieces: Uint8Array[] = [];
  private received = 0;
  /** Of the next strip with its prefix; of the prefix alone before that has come. */
  private needed = prefix;

  /** Takes bytes that follow those before; returns the strips that are whole now. */
  take(bytes: Uint8Array): DrawnPicture[] {
    this.pieces.push(bytes);
    this.received += bytes.length;
    const strips: DrawnPicture[] = [];
    while (this.received >= this.needed) {
      const whole = this.joined();
      const size = prefix + new DataView(whole.buffer, whole.byteOffset).getUint32(0, true);
      this.needed = size;
      if (whole.length >= size) {
        strips.push(drawn(whole.subarray(prefix, size)));
        this.pieces = [whole.subarray(size)];
        this.received -= size;
        this.needed = prefix;
      }
    }
    return strips;
  }

  /** All that waits, in one piece. */
  private joined(): Uint8Array {
    const whole = new Uint8Array(this.received);
    let filled = 0;
    for (const piece of this.pieces) {
      whole.set(piece, filled);
      filled += piece.length;
    }
    this.pieces = [whole];
    return whole;
  }
}

function drawn(packed: Uint8Array): DrawnPicture {
  const message = decodeToPage(packed);
  if (message.type !== "drawn_picture") {
    throw new Error(`the engine sent ${message.type} instead of a picture`);
  }
  return message;
}
