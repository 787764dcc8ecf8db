/**
 * The scale bar: a round length that fits into the picture.
 */
import { formatValue } from "../base/format";

export interface ScaleBar {
  readonly pixels: number;
  readonly label: string;
}

/** The longest of 1, 2, 5 · 10ⁿ mm that needs at most `mostPixels`. */
export function scaleBar(mmPerPixel: number, mostPixels: number): ScaleBar {
  const longest = mmPerPixel * mostPixels;
  const decade = 10 ** Math.floor(Math.log10(longest));
  const mm = [5, 2, 1].map((digit) => digit * decade).find((length) => length <= longest) ?? decade;
  const label = mm >= 10 ? formatValue(mm / 10, "cm") : formatValue(Number(mm.toPrecision(1)), "mm");
  return { pixels: mm / mmPerPixel, label };
}
