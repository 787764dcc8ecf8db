/**
 * Blend modes as people choose them, with the field's terms.
 */
import type { Blend } from "../../../core/appearance/optics";

export const blendNames: Readonly<Record<Blend, { readonly name: string; readonly title: string }>> = {
  shaded: { name: "Shaded", title: "Shaded composite: absorption and emission, lit where tissues meet" },
  composite: { name: "Composite, no light", title: "Composite: absorption and emission, front to back, in the tissue's own colours" },
  absorption: { name: "X-ray", title: "Absorption only: bright where much of the light is absorbed, as a radiograph" },
  emission: { name: "Emission", title: "Emission only: light of all tissue adds up, nothing hides anything" },
  mip: { name: "MIP", title: "Maximum intensity projection: the largest value on each ray" },
  minip: { name: "MinIP", title: "Minimum intensity projection: the least value between the first and the last tissue on each ray, or in a slab" },
  average: { name: "Average", title: "Average intensity projection: the mean between the first and the last tissue on each ray, or in a slab" },
  iso: { name: "Iso-surface", title: "The surface where the scan has one value" },
};
