/** What the qualities of the picture are called on the page. */
import { restingPictures, type Quality } from "../../../core/view/quality";

export const qualityNames: Readonly<Record<Quality, { readonly name: string; readonly title: string }>> = {
  fast: { name: "Fast", title: told("The quickest picture at rest", "fast") },
  balanced: { name: "Balanced", title: told("Smooth edges, soon after the view rests", "balanced") },
  fine: { name: "Fine", title: told("Thin things between voxels, smoother edges", "fine") },
  still: { name: "Still image", title: told("For pictures to keep: takes its time", "still") },
};

function told(what: string, quality: Quality): string {
  const { stepsPerVoxel, passes } = restingPictures[quality];
  const steps = `${String(stepsPerVoxel)} ${stepsPerVoxel === 1 ? "step" : "steps"} of a ray per voxel`;
  return `${what}: ${steps}, ${passes === 1 ? "one picture" : `${String(passes)} pictures averaged`}`;
}
