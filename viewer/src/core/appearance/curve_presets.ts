/**
 * Transfer functions by the names that the field uses. The curves are our own: of CT in HU, of other
 * scans in shares of the values that they hold. Where a CT has no HU they are placed by the values of
 * soft tissue and bone that were found in it.
 */
import type { Anchors } from "./soft_tissue_and_bone";
import type { Curve } from "./curve";
import { looks } from "./looks";

export interface Preset {
  readonly name: string;
  readonly title: string;
  readonly scale: "HU" | "share";
  /** Value and opacity of 1 mm in percent, by turns. */
  readonly opacities: readonly (readonly [number, number])[];
  readonly colours: readonly (readonly [number, string])[];
}

export const presets: readonly Preset[] = looks.presets;

/** What CT has in HU where soft tissue and bone are told apart. */
const inHu: Anchors = looks.anchors;

/** A preset at the values of a scan; `brightest` hardly any voxel exceeds, `lowest` is its least value. */
export function curveOfPreset(preset: Preset, anchors: Anchors, lowest: number, brightest: number): Curve {
  const stretch = (anchors.bone - anchors.softTissue) / (inHu.bone - inHu.softTissue);
  const place = (value: number): number =>
    preset.scale === "HU"
      ? anchors.softTissue + (value - inHu.softTissue) * stretch
      : lowest + value * Math.max(brightest - lowest, 1e-6);
  return {
    opacities: preset.opacities.map(([value, percent]) => ({ value: place(value), opacity: percent / 100 })),
    colours: preset.colours.map(([value, colour]) => ({ value: place(value), colour })),
  };
}
