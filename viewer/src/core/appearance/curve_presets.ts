/**
 * Transfer functions by the names that the field uses. The curves are our own: of CT in HU, of other
 * scans in shares of the values that they hold. Where a CT has no HU they are placed by the values of
 * soft tissue and bone that were found in it.
 */
import type { Anchors } from "./soft_tissue_and_bone";
import type { Curve } from "./curve";

export interface Preset {
  readonly name: string;
  readonly title: string;
  readonly scale: "HU" | "share";
  /** Value and opacity of 1 mm in percent, by turns. */
  readonly opacities: readonly (readonly [number, number])[];
  readonly colours: readonly (readonly [number, string])[];
}

export const presets: readonly Preset[] = [
  {
    name: "CT-Bone",
    title: "Bone alone, from spongy to dense",
    scale: "HU",
    opacities: [[120, 0], [230, 12], [420, 60], [1200, 90]],
    colours: [[120, "#b5654a"], [240, "#d9a87c"], [420, "#efdcba"], [1200, "#fdfaf0"]],
  },
  {
    name: "CT-Soft-Tissue",
    title: "Skin, fat and organs before bone",
    scale: "HU",
    opacities: [[-220, 0], [-90, 4], [-40, 3], [20, 14], [120, 16], [280, 60], [1000, 85]],
    colours: [
      [-220, "#cf9272"], [-90, "#e6bd8c"], [20, "#b5534a"],
      [120, "#c26a54"], [280, "#efdfc0"], [1000, "#fdf8ec"],
    ],
  },
  {
    name: "CT-Muscle",
    title: "Muscle and organs without fat, over bone",
    scale: "HU",
    opacities: [[-30, 0], [10, 3], [45, 30], [110, 35], [160, 22], [300, 70], [1000, 90]],
    colours: [
      [-30, "#7e2f28"], [45, "#a63d32"], [110, "#b8503d"],
      [220, "#dcb28a"], [300, "#efdfc0"], [1000, "#fdf8ec"],
    ],
  },
  {
    name: "CT-Fat",
    title: "Fat, with a hint of what it lies on",
    scale: "HU",
    opacities: [[-220, 0], [-140, 3], [-100, 18], [-55, 12], [-25, 0], [200, 0], [420, 20]],
    colours: [[-220, "#c9a05c"], [-100, "#f0cf83"], [-25, "#f3dba6"], [420, "#f6efe0"]],
  },
  {
    name: "CT-Chest-Contrast",
    title: "Heart and vessels filled with contrast, over bone",
    scale: "HU",
    opacities: [[90, 0], [140, 4], [190, 30], [300, 45], [420, 55], [1200, 85]],
    colours: [[90, "#7c1f1c"], [170, "#c0302a"], [260, "#e0644a"], [340, "#f2c8a0"], [1200, "#fdf8ec"]],
  },
  {
    name: "CT-Lung",
    title: "Vessels and tissue of the lung, bone only just seen",
    scale: "HU",
    opacities: [[-950, 0], [-860, 0.3], [-740, 1.2], [-600, 2.2], [-420, 1.2], [-250, 0], [180, 0], [600, 3]],
    colours: [[-950, "#27415e"], [-740, "#4f86ad"], [-560, "#a9c9d8"], [-250, "#e2b7a0"], [600, "#f7efe0"]],
  },
  {
    name: "CT-Airways",
    title: "The walls of trachea, bronchi and bowel gas",
    scale: "HU",
    opacities: [[-1000, 0], [-975, 0], [-900, 3], [-700, 5], [-520, 1], [-400, 0]],
    colours: [[-1000, "#3d6b86"], [-900, "#79b4c9"], [-700, "#cfe5ea"], [-400, "#f2e3d5"]],
  },
  {
    name: "CT-Vessels",
    title: "What is brighter than organs: angiography",
    scale: "HU",
    opacities: [[130, 0], [180, 8], [260, 50], [700, 75], [1500, 90]],
    colours: [[130, "#8e1b16"], [220, "#cf3b2e"], [380, "#ecb995"], [1500, "#fffaf0"]],
  },
  {
    name: "MR-Default",
    title: "Tissue of a magnetic resonance scan by its brightness",
    scale: "share",
    opacities: [[0.1, 0], [0.2, 2], [0.4, 8], [0.65, 20], [1, 40]],
    colours: [[0.1, "#59302a"], [0.3, "#a8604a"], [0.55, "#d9b08c"], [1, "#fbf6ea"]],
  },
  {
    name: "MR-Angio",
    title: "Bright vessels of a magnetic resonance angiography",
    scale: "share",
    opacities: [[0.42, 0], [0.52, 10], [0.7, 55], [1, 85]],
    colours: [[0.42, "#7c1f1c"], [0.6, "#d2452f"], [1, "#ffe9c9"]],
  },
];

/** What CT has in HU where soft tissue and bone are told apart. */
const inHu: Anchors = { softTissue: 40, bone: 250 };

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
