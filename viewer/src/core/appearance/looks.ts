/**
 * Numbers of looks that this page and pictures from Python share: both read them from one file.
 */
// eslint-disable-next-line palpate/arrows -- Python reads it as well
import given from "../../../../python/palpate/pictures/looks.json";
import type { Lighting } from "./appearance";
import type { Preset } from "./curve_presets";
import type { Blend, GreyBlend } from "./optics";
import type { Anchors, Stop } from "./soft_tissue_and_bone";

type Pair = readonly [number, number];

interface Looks {
  /** What CT has in HU where soft tissue and bone are told apart. */
  readonly anchors: Anchors;
  readonly presets: readonly Preset[];
  readonly tissue: {
    /** Of the sliders at first. */
    readonly softTissue: number;
    readonly bone: number;
    /** Extinction of opaque skin [1/mm] and of skin that is only just seen. */
    readonly strongestSoft: number;
    readonly weakestSoft: number;
    /** A boundary at full strength changes by this share of the soft-tissue-to-bone span per mm. */
    readonly edgeShare: number;
    readonly stops: readonly Stop[];
  };
  readonly modes: {
    /** Share of the voxels that may be brighter than white in a MIP. */
    readonly fewVoxels: number;
    /** Place of fat, from which on there is tissue, in tissue units. */
    readonly firstTissue: number;
    readonly densities: Readonly<Record<Exclude<Blend, GreyBlend | "iso">, number>>;
    /** Black and white in tissue units; white of a MIP is what hardly any voxel exceeds. */
    readonly windows: { readonly mip: readonly [number, null]; readonly minip: Pair; readonly average: Pair };
    /** [mm]; 0: all of the scan. */
    readonly slabs: Readonly<Record<GreyBlend, number>>;
  };
  readonly lighting: Lighting;
  /** Behind a picture, in its middle and at its edge. */
  readonly ground: { readonly centre: string; readonly edge: string };
  /** Of Python alone but for `air`: the camera's are beside it, and a test holds both together. */
  readonly framing: {
    /** Place below which all is air, in tissue units. */
    readonly air: number;
  };
}

// rows of JSON are arrays for the compiler, not pairs
export const looks = given as unknown as Looks;
