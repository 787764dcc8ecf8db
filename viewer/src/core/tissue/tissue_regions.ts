/**
 * Regions of a segment that take part in their own way: all of it, and what it shares with others.
 */
import type { MatterRegion, SegmentId, Treatment } from "../protocol";

export const treatments: readonly { readonly value: Treatment; readonly name: string; readonly title: string }[] = [
  { value: "deformable", name: "Gives way", title: "It gives way, as its material says" },
  { value: "rigid", name: "Hard", title: "It stays where it is, and holds what hangs on it" },
  { value: "empty", name: "Empty", title: "The model does as if it were not there" },
];

/** How all of a segment takes part, where no region says otherwise. */
export function wholeOf(regions: readonly MatterRegion[]): Treatment {
  return regions.filter((region) => !isPart(region)).at(-1)?.treatment ?? "deformable";
}

/** What is said of regions. */
export function partsOf(regions: readonly MatterRegion[]): readonly MatterRegion[] {
  return regions.filter(isPart);
}

/** All of the segment takes part so; its parts stay as they are. */
export function withWhole(regions: readonly MatterRegion[], treatment: Treatment): MatterRegion[] {
  const whole: MatterRegion = { treatment, shared_with: null, box: null };
  // of several that hold a voxel the last counts
  return [...(treatment === "deformable" ? [] : [whole]), ...partsOf(regions)];
}

/** What is shared with another segment takes part so; null where nothing is said of it any more. */
export function withShared(
  regions: readonly MatterRegion[],
  other: SegmentId,
  treatment: Treatment | null,
): MatterRegion[] {
  const known = regions.some(({ shared_with }) => shared_with === other);
  if (treatment === null) {
    return regions.filter(({ shared_with }) => shared_with !== other);
  }
  return known
    ? regions.map((region) => (region.shared_with === other ? { ...region, treatment } : region))
    : [...regions, { treatment, shared_with: other, box: null }];
}

/** "hard, but gives way where Lesion is"; null where all of it gives way. */
export function describeRegions(regions: readonly MatterRegion[], nameOf: (id: SegmentId) => string): string | null {
  const whole = wholeOf(regions);
  const parts = partsOf(regions).map(
    ({ treatment, shared_with }) =>
      `${word(treatment)} ${shared_with === null ? "in a box" : `where ${nameOf(shared_with)} is`}`,
  );
  const all = whole === "deformable" ? [] : [word(whole)];
  return all.length + parts.length === 0 ? null : [...all, ...parts].join(", ");
}

function word(treatment: Treatment): string {
  // @texts
  return { deformable: "gives way", rigid: "hard", empty: "as if empty" }[treatment];
}

function isPart({ shared_with, box }: MatterRegion): boolean {
  return shared_with !== null || box !== null;
}
