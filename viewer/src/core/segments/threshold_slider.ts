/**
 * The sliders of a threshold's ends. An input of a browser stops at the last whole step below its end, and so would
 * leave out the highest values of a scan.
 */
type Range = readonly [number, number];

const steps = 500;

/** By how much a slider over a range of values moves. */
export function sliderStep([low, high]: Range): number {
  const span = high - low;
  if (span > 100) {
    return 1;
  }
  return span > 0 ? span / steps : 1;
}

/** The value that a slider stands for: at its last step it is the end of the range. */
export function sliderValue(shown: number, range: Range): number {
  const step = sliderStep(range);
  // what is a whole step below the end but for rounding is not yet the end
  return shown > range[1] - (1 - 1e-6) * step ? range[1] : shown;
}
