/** Which range a segment has first that is added by a threshold. */
import type { Scan, Segment } from "../protocol";

type Values = Pick<Scan, "bone" | "range" | "soft_tissue">;
type Threshold = { readonly name: string; readonly low: number; readonly high: number };

/** A segment of all that is not air. */
export function skinThreshold({ bone, range: [least, most], soft_tissue: softTissue }: Values): Threshold {
  return { name: "Skin", low: Math.max(least, Math.round(softTissue - 1.4 * (bone - softTissue))), high: most };
}

/** A segment that is made by a threshold: from bone upward, or, where there is one, from skin upward. */
export function newThreshold(
  scan: Values,
  segments: readonly Pick<Segment, "range" | "made_by">[],
): Threshold {
  const { bone, range } = scan;
  // one that was edited since is bone still
  const hasBone = segments.some((segment) => (segment.range ?? segment.made_by)?.[0] === bone);
  return hasBone ? skinThreshold(scan) : { name: "Bone", low: bone, high: range[1] };
}
