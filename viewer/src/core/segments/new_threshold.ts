/** Which range a segment has first that is added by a threshold. */
import type { Scan, Segment } from "../protocol";

/** A segment that is made by a threshold: from bone upward, or, where there is one, from skin upward. */
export function newThreshold(
  { bone, range: [least, most], soft_tissue: softTissue }: Pick<Scan, "bone" | "range" | "soft_tissue">,
  segments: readonly Pick<Segment, "range" | "made_by">[],
): { readonly name: string; readonly low: number; readonly high: number } {
  // one that was edited since is bone still
  const hasBone = segments.some(({ range, made_by: madeBy }) => (range ?? madeBy)?.[0] === bone);
  const skin = Math.round(softTissue - 1.4 * (bone - softTissue));
  return { name: hasBone ? "Skin" : "Bone", low: hasBone ? Math.max(least, skin) : bone, high: most };
}
