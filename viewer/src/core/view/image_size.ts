/** How large a picture can be saved: what a browser's canvas holds. Sizes in pixels. */
import type { Viewport } from "../geometry/camera";

export const magnifications = [1, 2, 3, 4, 6, 8] as const;

/** Longest edge, and most pixels: half a gigabyte of them. */
export const mostEdge = 16384;
export const mostPixels = 2 ** 27;

/** Size of a view's picture. @param ratio pixels of the screen per CSS pixel. */
export function imageSize({ width, height }: Viewport, ratio: number, magnification: number): Viewport {
  return { width: Math.round(width * ratio * magnification), height: Math.round(height * ratio * magnification) };
}

/** The same but for a pixel, with even edges: videos have such, and pictures of which each eye has half. */
export function evenSize({ width, height }: Viewport): Viewport {
  return { width: width - (width % 2), height: height - (height % 2) };
}

export function fitsIntoCanvas({ width, height }: Viewport): boolean {
  return Math.max(width, height) <= mostEdge && width * height <= mostPixels;
}

/** A part of a picture; its corner counts from the lower left. */
export interface Tile {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/** Tiles of at most `edge` pixels that cover a picture once, row by row. */
export function tilesOf({ width, height }: Viewport, edge: number): Tile[] {
  const starts = (size: number): number[] => Array.from({ length: Math.ceil(size / edge) }, (_, i) => i * edge);
  return starts(height).flatMap((y) =>
    starts(width).map((x) => ({ x, y, width: Math.min(edge, width - x), height: Math.min(edge, height - y) })),
  );
}
