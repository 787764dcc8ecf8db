import { expect, test } from "vitest";
import {
  nothingRemembered,
  recalledTissue,
  recalledRegions,
  rememberedTissue,
} from "../../../src/core/tissue/tissue_memory";
import { usualOptions } from "../../../src/core/tissue/model_options";
import type { Constants, DeformationModel, MaterialPreset, MatterRegion, Segment } from "../../../src/core/protocol";

const fades = { shares: { least: 0.01, most: 0.95 }, times: { least: 0.01, most: 1000 } };
const yields = { least: 0.005, most: 0.5 };

const soft: Constants = {
  young: 5500, poisson: 0.45, density: 1060,
  fracture_energy: 164, friction: 0.2, stiffening: 0,
};
const presets: readonly MaterialPreset[] = [
  { name: "liver", source: "a paper", needs_hounsfield: false, low: soft, high: soft },
];
const models: readonly DeformationModel[] = [
  {
    ...{ name: "lattice", title: "Lattice", bonded: true, boxes: { least: 9, usual: 21, most: 41 }, binding: null },
    ...{ walls: false, fades, yields, layers: null, calibration: false, motion: false, whole_segment: false },
  },
  {
    ...{ name: "global-lj", title: "Particles", bonded: false, boxes: null },
    ...{ binding: { least: 0.01, usual: 0.3, most: 2 }, walls: false, fades: null, yields: null, layers: null },
    ...{ calibration: true, motion: false, whole_segment: false },
  },
];

test("what was chosen comes back, by the names of segments", () => {
  const options = { ...usualOptions, edge: 31, prony: { share: 0.4, time: 2 }, yield_strain: 0.05 };
  const own = { ...soft, young: 7000 };
  const segments = [
    { id: 1, name: "liver", material: { preset: "liver", low: soft, high: soft }, regions: [] },
    { id: 2, name: "lump", material: { preset: null, low: own, high: own }, regions: [] },
    { id: 3, name: "bone", material: null, regions: [] },
  ];
  const kept: unknown = JSON.parse(
    JSON.stringify(rememberedTissue(segments, { model: "lattice", options, force_source: "voxels" })),
  );
  expect(recalledTissue(kept, presets, models)).toEqual({
    version: 1,
    model: "lattice",
    options,
    forceSource: "voxels",
    materials: [
      { segment: "liver", preset: "liver", constants: null },
      { segment: "lump", preset: null, constants: own },
    ],
    regions: [],
  });
});

test("constants kept by versions that did not know of stiffening have none", () => {
  const before = { young: 7000, poisson: 0.45, density: 1060, fracture_energy: 164, friction: 0.2 };
  const materials = [{ segment: "lump", preset: null, constants: before }];
  expect(recalledTissue({ version: 1, materials }, presets, models).materials).toEqual([
    { segment: "lump", preset: null, constants: { ...before, stiffening: 0 } },
  ]);
  const wild = [{ segment: "lump", preset: null, constants: { ...before, stiffening: 1e9 } }];
  expect(recalledTissue({ version: 1, materials: wild }, presets, models).materials).toEqual([]);
});

test.each([
  null,
  7,
  {},
  { version: 2, model: "lattice", edge: null, materials: [] },
  { version: 1, materials: "liver" },
])("of a memory like %o nothing is recalled", (memory) => {
  expect(recalledTissue(memory, presets, models)).toEqual(nothingRemembered);
});

test("of a memory only what is offered and can be is recalled", () => {
  const constants = { ...soft, poisson: 0.6 };
  const materials = [
    { segment: "a", preset: "cheese" },
    { segment: "b", constants },
    3,
    { segment: "c", preset: "liver" },
  ];
  expect(recalledTissue({ version: 1, model: "jelly", options: usualOptions, materials }, presets, models)).toEqual({
    ...nothingRemembered,
    materials: [{ segment: "c", preset: "liver", constants: null }],
  });
  const recalled = (model: string, options: unknown): unknown =>
    recalledTissue({ version: 1, model, options, materials }, presets, models).options;
  expect(
    recalled("lattice", { edge: 20, binding: 0.5, walls: true, prony: { share: 2, time: 1 }, yield_strain: 0.9 }),
  ).toEqual(usualOptions);
  expect(recalled("lattice", { edge: 11, prony: null })).toEqual({ ...usualOptions, edge: 11 });
  expect(recalled("global-lj", { edge: 11, binding: 0.5, prony: { share: 0.5, time: 1 }, yield_strain: 0.1 })).toEqual({
    ...usualOptions,
    binding: 0.5,
  });
  expect(recalled("global-lj", "all")).toEqual(usualOptions);
});

test("regions come back where the segments are that mark them, in their order", () => {
  const regions: readonly MatterRegion[] = [
    { treatment: "rigid", shared_with: null, box: null },
    { treatment: "deformable", shared_with: 3, box: null },
    { treatment: "empty", shared_with: null, box: [[0, 0, 0], [4, 4, 4]] },
    { treatment: "empty", shared_with: 9, box: null },
  ];
  const named = (
    id: number,
    name: string,
    its: readonly MatterRegion[] = [],
  ): Pick<Segment, "id" | "name" | "material" | "regions"> => ({ id, name, material: null, regions: its });
  const kept: unknown = JSON.parse(
    JSON.stringify(
      rememberedTissue([named(1, "liver", regions), named(3, "lesion")], {
        model: null,
        options: usualOptions,
        force_source: "matter",
      }),
    ),
  );
  const memory = recalledTissue(kept, presets, models);
  expect(memory.regions).toHaveLength(2);
  // under other numbers at the next visit
  const now = [named(5, "lesion"), named(6, "liver")];
  expect(recalledRegions("liver", memory, now)).toEqual([
    { treatment: "rigid", shared_with: null, box: null },
    { treatment: "deformable", shared_with: 5, box: null },
  ]);
  expect(recalledRegions("liver", memory, now.slice(1))).toHaveLength(1);
  expect(recalledRegions("lesion", memory, now)).toEqual([]);
  const damaged = {
    version: 1,
    materials: [],
    regions: [{ segment: "liver", treatment: "soft", sharedWith: null }, 3, { segment: 2 }],
  };
  expect(recalledTissue(damaged, presets, models).regions).toEqual([]);
});
