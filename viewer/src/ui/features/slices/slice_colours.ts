/** Colours of the slices: of their names, and of the lines that show where the others cut them. */
import type { SliceName } from "../../../core/slices/slice_plane";

const axial = "#ff8f80";
const coronal = "#7fe0a0";
const sagittal = "#ffd166";
const oblique = "#b8c4d2";

export const lineColours: Readonly<
  Record<SliceName, { readonly own: string; readonly across: string; readonly upright: string }>
> = {
  axial: { own: axial, across: coronal, upright: sagittal },
  coronal: { own: coronal, across: axial, upright: sagittal },
  sagittal: { own: sagittal, across: axial, upright: coronal },
  oblique: { own: oblique, across: oblique, upright: oblique },
};
