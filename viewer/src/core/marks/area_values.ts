/** What the engine measures of areas, and how it is written. Values are in the scan's unit, areas in mm². */
import { afterNumber, formatFixed, formatValue, formatWithin } from "../base/format";

/** As the engine answers; without a voxel inside there are no values. */
export interface AreaValues {
  readonly area: number;
  /** Voxels with a value. */
  readonly count: number;
  readonly mean: number | null;
  readonly standard_deviation: number | null;
  readonly minimum: number | null;
  readonly maximum: number | null;
  /** A part of it lies outside of the scan. */
  readonly cut: boolean;
}

/** Values of a scan, for how they are written. */
export interface ValueScale {
  /** Empty where there is none. */
  readonly unit: string;
  /** From the least to the largest value of the scan. */
  readonly span: number;
}

export function valueScale(scan: { readonly unit: string; readonly range: readonly [number, number] } | null): ValueScale {
  return scan === null
    ? { unit: "", span: 1 }
    : { unit: scan.unit, span: scan.range[1] - scan.range[0] };
}

/** Mean and SD have a digit more than single values have. */
const moreDigits = 10;

/** "312 mm²", "12.3 mm²" */
export function formatArea(area: number): string {
  return formatFixed(area, area < 99.95 ? 1 : 0, "mm²");
}

/** Lines that tell the values: mean and SD, then the ends and where they are not all of it. */
export function valueLines(values: AreaValues | null, { unit, span }: ValueScale): readonly string[] {
  if (values === null) {
    return [];
  }
  const { mean, standard_deviation: deviation, minimum, maximum, cut } = values;
  if (mean === null || deviation === null || minimum === null || maximum === null) {
    return [cut ? "outside of the scan" : "no voxel inside"];
  }
  const finely = (value: number): string => formatWithin(value, span / moreDigits);
  const after = afterNumber(unit);
  return [
    `mean ${finely(mean)} \u00b1 ${finely(deviation)}${after}`,
    `${formatValue(minimum)} to ${formatValue(maximum)}${after}${cut ? ", cut by the scan's edge" : ""}`,
  ];
}
