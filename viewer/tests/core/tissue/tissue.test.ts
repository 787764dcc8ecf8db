import { expect, test } from "vitest";
import { decodeDisplacements } from "../../../src/core/scan/displacements";
import {
  AnswerRate,
  constantsOf,
  describeMaterial,
  edgeOf,
  formatModulus,
  movedTissue,
  oddEdge,
  presetsFor,
  presetTitle,
  softTissues,
  suggestedPreset,
} from "../../../src/core/tissue/tissue";
import { decodeParticles } from "../../../src/core/tissue/particles";
import type {
  Constants,
  DeformationModel,
  Displaced,
  MaterialPreset,
  MatterParts,
  Segment,
} from "../../../src/core/protocol";

const fades = { shares: { least: 0.01, most: 0.95 }, times: { least: 0.01, most: 1000 } };
const yields = { least: 0.005, most: 0.5 };

const soft: Constants = {
  young: 5500, poisson: 0.45, density: 1060,
  fracture_energy: 164, friction: 0.2, stiffening: 0,
};
const hard: Constants = { ...soft, young: 21e9, poisson: 0.32 };
const presets: readonly MaterialPreset[] = [
  { name: "liver", source: "a paper", needs_hounsfield: false, low: soft, high: soft },
  {
    name: "thesis-bone",
    source: "thesis",
    needs_hounsfield: true,
    low: { ...hard, young: 5e9, poisson: 0.3 },
    high: hard,
  },
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

test("a segment without a known tissue is asked for one: the most alike first, and nothing as hard as bone", () => {
  const named = (name: string, young: number): MaterialPreset => {
    const constants = { ...soft, young };
    return { name, source: "", needs_hounsfield: false, low: constants, high: constants };
  };
  const organs = ["fat", "muscle", "vessel-wall"].map((name) => named(name, 12e3));
  const all = [...presets, ...organs, named("cartilage", 7e5), named("bone", 3e8)];
  const asked = (name: string): string[] => softTissues(name, all).map((preset) => preset.name);
  expect(asked("Pancreas")).toEqual(["liver", "fat", "muscle", "vessel-wall", "cartilage"]);
  expect(asked("Bladder")).toEqual(["muscle", "liver", "fat", "vessel-wall", "cartilage"]);
  expect(asked("inferior vena cava")[0]).toBe("vessel-wall");
  expect(asked("Region 2")[0]).toBe("liver");
});

test("moduli are written with three digits and the unit that fits", () => {
  expect([500, 999.6, 5500, 4.2e5, 18.6e9].map(formatModulus)).toEqual([
    "500\u202fPa",
    "1.00\u202fkPa",
    "5.50\u202fkPa",
    "420\u202fkPa",
    "18.6\u202fGPa",
  ]);
});

test("a material that follows HU is told from one end to the other and has no constants to change", () => {
  const [liver, bone] = presets.map((preset) => ({ ...preset, preset: preset.name }));
  expect(liver && describeMaterial(liver)).toBe(
    "5.50\u202fkPa, ν 0.45, 1.06\u202fg/cm³, tears at 164\u202fJ/m², friction 20\u202f%",
  );
  expect(bone && describeMaterial(bone)).toBe(
    "5.00\u202fGPa to 21.0\u202fGPa, ν 0.3 to 0.32, 1.06\u202fg/cm³, tears at 164\u202fJ/m², friction 20\u202f%",
  );
  expect(
    describeMaterial({ low: { ...soft, fracture_energy: null }, high: { ...soft, fracture_energy: null } }),
  ).toContain("never tears");
  const stiffer = { ...soft, stiffening: 8 };
  expect(describeMaterial({ low: stiffer, high: stiffer })).toContain("friction 20\u202f%, stiffens by 8");
  expect(presets.map(presetTitle)).toEqual(["Liver", "Thesis bone (by HU)"]);
  expect(liver && constantsOf(liver)).toEqual(soft);
  expect(bone && constantsOf(bone)).toBeNull();
  expect(presetsFor(presets, "")).toEqual(presets.slice(0, 1));
  expect(presetsFor(presets, "HU")).toEqual(presets);
});

test("a segment's name suggests a tissue only where it is offered", () => {
  expect(suggestedPreset("Liver, part 3", presets)).toBe("liver");
  expect(suggestedPreset("left gluteus maximus", presets)).toBeNull();
  expect(suggestedPreset("bone", presets)).toBeNull();
  const organs = ["kidney", "lung", "tumour", "spleen"].map((name) => {
    return { name, source: "", needs_hounsfield: false, low: soft, high: soft };
  });
  const suggested = ["Left kidney", "Adrenal gland", "Lung tumor", "lungs", "Spleen"];
  expect(suggested.map((name) => suggestedPreset(name, organs))).toEqual(["kidney", null, "tumour", "lung", "spleen"]);
});

test("the edge of a box is odd and within what the model can have", () => {
  const [lattice, whole] = models;
  expect([edgeOf(lattice, null), edgeOf(lattice, 31), edgeOf(whole, 31), edgeOf(undefined, 31)]).toEqual([
    21,
    31,
    null,
    null,
  ]);
  expect([1, 20, 22.4, 99].map((edge) => lattice?.boxes && oddEdge(edge, lattice.boxes))).toEqual([9, 21, 23, 41]);
});

test("answers are counted over the last second, and begin anew with another session", () => {
  const rate = new AnswerRate();
  expect(rate.hz).toBe(0);
  for (let i = 0; i <= 300; ++i) {
    rate.add(i / 100, Math.floor((30 * i) / 100));
  }
  expect(rate.hz).toBeCloseTo(30, 0);
  for (let i = 301; i <= 420; ++i) {
    rate.add(i / 100, 90);
  }
  expect(rate.hz).toBe(0);
  rate.add(0.1, 0);
  rate.add(0.2, 4);
  expect(rate.hz).toBeCloseTo(40);
});

test("displacements whose bytes do not fit are refused", () => {
  const moved = new Uint8Array(new Uint16Array([0x3c00, 0, 0, 0, 0, 0, 0, 0]).buffer);
  const sent: Displaced = { origin: [0, 0, 0], step: [1, 1, 2], size: [2, 1, 1], moved };
  expect([...decodeDisplacements(sent).moved]).toEqual([0x3c00, 0, 0, 0, 0, 0, 0, 0]);
  expect(() => decodeDisplacements({ ...sent, size: [0, 1, 1], moved: new Uint8Array(0) })).toThrow("no nodes");
  expect(() => decodeDisplacements({ ...sent, moved: new Uint8Array(15) })).toThrow(
    "15 bytes of displacements for 2 x 1 x 1 nodes, 8 each",
  );
  expect(() => decodeDisplacements({ ...sent, step: [1, 0, 1] })).toThrow("1, 0, 1 voxels apart");
});

test("parts are read where each has a place", () => {
  const bytes = { places: new Uint8Array(12), strains: Uint8Array.from([127, 129]) };
  const parts: MatterParts = { type: "matter_parts", origin: [0, 0, 0], size: [1, 1, 1], apart: 1, ...bytes };
  expect([...(decodeParticles(parts)?.strains ?? [])]).toEqual([127, -127]);
  expect(decodeParticles({ ...parts, places: new Uint8Array(11) })).toBeNull();
});

test("soft tissue that was moved is told apart from what is hard anyway", () => {
  const material = presets[0];
  const pose = [0, 0, 0];
  const segments = [{ material, pose }, { material, pose: null }, { material: null, pose }];
  expect(movedTissue(segments as unknown as Segment[])).toEqual([segments[0]]);
});
