/**
 * By how much the screen divides its own pixels while the view moves and the CPU draws: to enlarge a coarse picture to
 * all of them took half of a frame, and browsers do it in less time.
 */

/** Pixels of the screen that are drawn in a few milliseconds. */
const fewPixels = 600_000;

/**
 * @param pixels of the canvas at rest.
 * @returns a power of two: 2 at least, and no more than leaves a picture of `divisor` twice as coarse as the screen.
 */
export function screenDivisor(pixels: number, divisor: number): number {
  let divided = 2;
  while (pixels / divided ** 2 > fewPixels && 4 * divided <= divisor) {
    divided *= 2;
  }
  return divided;
}
