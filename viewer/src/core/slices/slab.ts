/** What a pixel of a slice shows of the values that a slab gathers along the slice's normal. */
export const slabModes = ["mean", "largest", "least"] as const;
export type SlabMode = (typeof slabModes)[number];

export const slabNames: Readonly<Record<SlabMode, { readonly name: string; readonly title: string }>> = {
  mean: { name: "Mean", title: "The mean value in the slab" },
  largest: { name: "MIP", title: "Maximum intensity projection: the largest value in the slab" },
  least: { name: "MinIP", title: "Minimum intensity projection: the least value in the slab" },
};
