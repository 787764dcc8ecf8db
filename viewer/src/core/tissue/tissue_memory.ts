/**
 * What a person has chosen of soft tissue, for the next visit: kept for each scan, in the
 * browser. Segments are known by their names.
 */
import { treatments } from "./tissue_regions";
import { recalledOptions, usualOptions } from "./model_options";
import type {
  Constants,
  DeformationModel,
  ForceSource,
  MaterialPreset,
  MatterRegion,
  MatterState,
  ModelOptions,
  Segment,
  Treatment,
} from "../protocol";

/** What was chosen for one scan. */
export interface TissueMemory {
  readonly version: number;
  readonly model: string | null;
  /** Of the model, where they are not as usual. */
  readonly options: ModelOptions;
  readonly forceSource: ForceSource;
  readonly materials: readonly RememberedMaterial[];
  readonly regions: readonly RememberedRegion[];
}

export interface RememberedMaterial {
  readonly segment: string;
  readonly preset: string | null;
  readonly constants: Constants | null;
}

/** A region of a segment, and whom it is shared with; null for all of the segment. */
export interface RememberedRegion {
  readonly segment: string;
  readonly treatment: Treatment;
  readonly sharedWith: string | null;
}

/** Form of what is kept; another number means that nothing kept before is read. */
const memoryVersion = 1;

export const nothingRemembered: TissueMemory = {
  version: memoryVersion,
  model: null,
  options: usualOptions,
  forceSource: "matter",
  materials: [],
  regions: [],
};

type NamedSegment = Pick<Segment, "id" | "name" | "material" | "regions">;

/** What to keep of segments and the model. */
export function rememberedTissue(
  segments: readonly NamedSegment[],
  { model, options, force_source }: Pick<MatterState, "model" | "options" | "force_source">,
): TissueMemory {
  const materials = segments.flatMap(({ name, material }): RememberedMaterial[] =>
    material === null
      ? []
      : [{ segment: name, preset: material.preset, constants: material.preset === null ? material.low : null }],
  );
  const regions = segments.flatMap((segment) => rememberedRegions(segment, segments));
  return { version: memoryVersion, model, options, forceSource: force_source, materials, regions };
}

/** Those of one segment; boxes of voxels are a program's, and not kept. */
function rememberedRegions(
  { name, regions }: NamedSegment,
  segments: readonly NamedSegment[],
): readonly RememberedRegion[] {
  return regions.flatMap(({ treatment, shared_with, box }): RememberedRegion[] => {
    const other = segments.find(({ id }) => id === shared_with);
    const gone = shared_with !== null && other === undefined;
    return box !== null || gone ? [] : [{ segment: name, treatment, sharedWith: other?.name ?? null }];
  });
}

/** Regions of a segment as they were kept, by the segments that there are now. */
export function recalledRegions(
  name: string,
  { regions }: TissueMemory,
  segments: readonly NamedSegment[],
): MatterRegion[] {
  return regions.flatMap(({ segment, treatment, sharedWith }): MatterRegion[] => {
    const other = segments.find((each) => each.name === sharedWith);
    const gone = sharedWith !== null && other === undefined;
    return segment !== name || gone ? [] : [{ treatment, shared_with: other?.id ?? null, box: null }];
  });
}

/** Reads what was kept; anything may have been written there. What is not offered is left out. */
export function recalledTissue(
  memory: unknown,
  presets: readonly MaterialPreset[],
  models: readonly DeformationModel[],
): TissueMemory {
  const { version, model, options, forceSource, materials, regions } = asMap(memory);
  if (version !== memoryVersion || !Array.isArray(materials)) {
    return nothingRemembered;
  }
  const known = models.find(({ name }) => name === model);
  const kept = materials.flatMap((each: unknown): RememberedMaterial[] => {
    const { segment, preset, constants } = asMap(each);
    const name = presets.find((offered) => offered.name === preset)?.name ?? null;
    // what was kept by versions before has no stiffening
    const given = { stiffening: 0, ...asMap(constants) };
    const own = isConstants(given) ? given : null;
    return typeof segment === "string" && (name !== null || own !== null)
      ? [{ segment, preset: name, constants: own }]
      : [];
  });
  return {
    version: memoryVersion,
    model: known?.name ?? null,
    options: known === undefined ? usualOptions : recalledOptions(options, known),
    // what was kept by versions before has none of options, this and regions
    forceSource: forceSource === "voxels" ? "voxels" : "matter",
    materials: kept,
    regions: Array.isArray(regions) ? regions.filter(isRegion) : [],
  };
}

function isRegion(value: unknown): value is RememberedRegion {
  const { segment, treatment, sharedWith } = asMap(value);
  return (
    typeof segment === "string" &&
    treatments.some((each) => each.value === treatment) &&
    (sharedWith === null || typeof sharedWith === "string")
  );
}

function isConstants(value: unknown): value is Constants {
  const { young, poisson, density, fracture_energy, friction, stiffening } = asMap(value);
  const within = (number: unknown, low: number, high: number): boolean =>
    typeof number === "number" && number >= low && number <= high;
  return (
    within(young, 1, 2e12) &&
    within(poisson, -0.999, 0.4999) &&
    within(density, 0.1, 23_000) &&
    (fracture_energy === null || within(fracture_energy, 1e-9, 1e6)) &&
    within(friction, 0, 10) &&
    within(stiffening, 0, 100)
  );
}

function asMap(value: unknown): Readonly<Record<string, unknown>> {
  return typeof value === "object" && value !== null && !Array.isArray(value) ? { ...value } : {};
}
