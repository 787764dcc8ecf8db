/**
 * What of a picture of the engine goes to the GPU: as it came, or unpacked from a WebP picture and deflated depths.
 */
import type { DrawnPicture } from "../../core/protocol";

export interface PictureTexels {
  readonly picture: DrawnPicture;
  /** Half floats, or a picture of twice as many rows: see `DrawnPicture`. */
  readonly colours: Uint16Array | ImageBitmap;
  readonly depths: Uint16Array;
  readonly depthSize: readonly [number, number];
}

/** Columns, and rows of all eyes. */
export function texelSize(picture: Pick<DrawnPicture, "size" | "eyes">): readonly [number, number] {
  const { size: [columns, rows], eyes } = picture;
  return [columns, rows * eyes];
}

/** Of a picture that is not packed. */
export function rawTexels(picture: DrawnPicture): PictureTexels {
  return { picture, colours: halves(picture.colours), depths: halves(picture.depths), depthSize: texelSize(picture) };
}

/** Of a packed picture; unpacked beside the page's own work. */
export async function unpackedTexels(picture: DrawnPicture): Promise<PictureTexels> {
  const [columns, rows] = picture.size;
  const every = picture.depth_every;
  const depthSize = [Math.ceil(columns / every), picture.eyes * Math.ceil(rows / every)] as const;
  const [colours, planes] = await Promise.all([
    createImageBitmap(new Blob([picture.colours.slice()]), {
      premultiplyAlpha: "none",
      colorSpaceConversion: "none",
    }),
    inflated(picture.depths),
  ]);
  return { picture, colours, depths: summed(planes, depthSize), depthSize };
}

/** 16-bit values; they may lie anywhere in the message. */
function halves(bytes: Uint8Array): Uint16Array {
  return new Uint16Array(bytes.slice().buffer);
}

async function inflated(bytes: Uint8Array): Promise<Uint8Array> {
  const stream = new Blob([bytes.slice()]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Sums of differences along rows, of which all low bytes come first and then all high ones. */
export function summed(planes: Uint8Array, [columns, rows]: readonly [number, number]): Uint16Array {
  const count = columns * rows;
  const values = new Uint16Array(count);
  for (let row = 0; row < rows; row += 1) {
    let sum = 0;
    for (let at = row * columns; at < (row + 1) * columns; at += 1) {
      // wraps at 65536, as the texel does
      sum += (planes[at] ?? 0) + 256 * (planes[count + at] ?? 0);
      values[at] = sum;
    }
  }
  return values;
}
