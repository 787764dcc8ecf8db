/**
 * Blend modes, qualities and modes of stereo as people choose them, with the field's terms.
 */
import { restingPictures, type Quality } from "../view/quality";
import type { StereoMode } from "../view/stereo";
import type { Blend } from "./optics";

export interface Named {
  readonly name: string;
  readonly title: string;
}

export const blendNames: Readonly<Record<Blend, Named>> = {
  shaded: { name: "Shaded", title: "Shaded composite: absorption and emission, lit where tissues meet" },
  composite: {
    name: "Composite, no light",
    title: "Composite: absorption and emission, front to back, in the tissue's own colours",
  },
  absorption: {
    name: "X-ray",
    title: "Absorption only: bright where much of the light is absorbed, as a radiograph",
  },
  emission: { name: "Emission", title: "Emission only: light of all tissue adds up, nothing hides anything" },
  mip: { name: "MIP", title: "Maximum intensity projection: the largest value on each ray" },
  minip: {
    name: "MinIP",
    title:
      "Minimum intensity projection: the least value between the first and the last tissue on each ray, or in a slab",
  },
  average: {
    name: "Average",
    title: "Average intensity projection: the mean between the first and the last tissue on each ray, or in a slab",
  },
  iso: { name: "Iso-surface", title: "The surface where the scan has one value" },
};

export const qualityNames: Readonly<Record<Quality, Named>> = {
  fast: { name: "Fast", title: qualityTitle("The quickest picture at rest", "fast") },
  balanced: { name: "Balanced", title: qualityTitle("Smooth edges, soon after the view rests", "balanced") },
  fine: { name: "Fine", title: qualityTitle("Thin things between voxels, smoother edges", "fine") },
  still: { name: "Still image", title: qualityTitle("For pictures to keep: takes its time", "still") },
};

export const stereoNames: Readonly<Record<StereoMode, Named>> = {
  off: { name: "One, no stereo", title: "One picture for both eyes" },
  anaglyph: {
    name: "Red–cyan anaglyph",
    title: "Both pictures in one, for glasses that are red at the left and cyan at the right",
  },
  side: { name: "Side by side", title: "The left eye's picture beside the right eye's" },
  stacked: { name: "Top–bottom", title: "The left eye's picture above the right eye's" },
};

function qualityTitle(what: string, quality: Quality): string {
  const { stepsPerVoxel, passes } = restingPictures[quality];
  // @texts
  const steps = `${String(stepsPerVoxel)} ${stepsPerVoxel === 1 ? "step" : "steps"} of a ray per voxel`;
  return `${what}: ${steps}, ${passes === 1 ? "one picture" : `${String(passes)} pictures averaged`}`;
}
