import { expect, test } from "vitest";
import { firstLighting, type Appearance } from "../../../src/core/appearance/appearance";
import { engineLook } from "../../../src/core/drawing/engine_look";
import { shadedOptics } from "../../../src/core/appearance/optics";
import type { Segment } from "../../../src/core/protocol";
import type { SecondAppearance } from "../../../src/core/second/second_scan";
import { rangesInside, shownRanges, type InsideModes } from "../../../src/core/segments/shown_segments";
import { segment } from "../../support/volumes";

const rescale = { slope: 2, intercept: -1000 };
const points = [
  { value: 0, colour: [0, 0, 0], extinction: 0 },
  { value: 100, colour: [1, 0.5, 0], extinction: 2 },
] as const;

function lookOf(
  segments: readonly Segment[],
  modes: InsideModes = {},
  part: Partial<Appearance> = {},
  second: SecondAppearance | null = null,
): ReturnType<typeof engineLook> {
  const appearance: Appearance = {
    transferFunction: { points },
    ranges: rangesInside(shownRanges(segments, rescale), modes),
    edgeGradient: 30,
    lighting: firstLighting,
    optics: { ...shadedOptics, isoValue: 50 },
    ...part,
  };
  return engineLook(appearance, { segments, modes }, [{ normal: [1, 0, 0], offset: 5 }], second);
}

const bone: Segment = { ...segment, id: 1, visible: true, shown_as: "volume", range: [100, 300] };
const painted: Segment = { ...segment, id: 2, visible: true, shown_as: "volume", range: null, made_by: null };

test("values, light and planes go out in physical units", () => {
  const look = lookOf([]);
  expect(look).toMatchObject({
    mode: "shaded",
    transfer: [[0, [0, 0, 0], 0], [100, [1, 0.5, 0], 2]],
    window: [400, 40],
    iso_colour: [0.5, 0.25, 0],
    edge_gradient: 30,
    slab: null,
    clip: [[[1, 0, 0], 5]],
    segments: [],
  });
});

test("a second scan goes out in its own units, by the window of the mode, where the view shows it", () => {
  const windows = { mip: { window: 300, level: 20 }, minip: { window: 1, level: 2 }, average: { window: 3, level: 4 } };
  const second: SecondAppearance = {
    inView: true,
    inSlices: true,
    viewFusion: "blend",
    transferFunction: { points },
    density: 2,
    edgeGradient: 12,
    isoValue: 50,
    tissueFrom: -100,
    windows,
    window: { window: 9, level: 9 },
    fusion: "blend",
    tint: "cool",
    opacity: 0.4,
    square: 10,
    lines: [],
    turn: "second",
  };
  expect(lookOf([]).second).toBeNull();
  expect(lookOf([], {}, {}, { ...second, inView: false }).second).toBeNull();
  expect(lookOf([], {}, {}, second).second).toEqual({
    density: 2,
    transfer: [[0, [0, 0, 0], 0], [100, [1, 0.5, 0], 2]],
    edge_gradient: 12,
    window: [300, 20],
    iso_value: 50,
    iso_colour: [0.5, 0.25, 0],
    tissue_from: -100,
    tint: "cool",
    opacity: 0.4,
    turns: "together",
    cells: 10,
  });
  const turns = (viewFusion: "checkerboard" | "flicker", turn: "first" | "second"): string | undefined =>
    lookOf([], {}, {}, { ...second, viewFusion, turn }).second?.turns;
  expect(turns("checkerboard", "first")).toBe("cells");
  expect(turns("flicker", "second")).toBe("second");
  expect(turns("flicker", "first")).toBeUndefined();
});

test("a scan whose tissue has one value alone has spans that the engine can divide by", () => {
  const optics = { ...shadedOptics, window: { window: 0, level: 1000 } };
  const { edge_gradient, window } = lookOf([], {}, { edgeGradient: 0, optics });
  expect(edge_gradient).toBeGreaterThan(0);
  expect(window[0]).toBeGreaterThan(0);
  expect(window[1]).toBe(1000);
});

test("a threshold goes out by its limits, a painted segment by its voxels", () => {
  const { segments } = lookOf([bone, painted]);
  expect(segments.map(({ id, range, edited, shown }) => ({ id, range, edited, shown }))).toEqual([
    { id: 1, range: [100, 300], edited: false, shown: "solid" },
    { id: 2, range: null, edited: false, shown: "solid" },
  ]);
});

test("an edited threshold keeps the limits that made it", () => {
  const { segments } = lookOf([{ ...bone, range: null, made_by: [100, 300] }]);
  expect(segments).toMatchObject([{ id: 1, range: [100, 300], edited: true, shown: "solid" }]);
});

test("hidden ones, tinted ones, plain ones and surfaces", () => {
  const surface = { ...painted, id: 3, shown_as: "surface" as const };
  const hidden = { ...bone, id: 4, visible: false };
  const { segments } = lookOf([bone, painted, surface, hidden], { 1: "tinted", 2: "plain" });
  expect(segments.map(({ id, shown }) => [id, shown])).toEqual([[1, "tinted"], [4, "hidden"], [3, "hidden"]]);
});

test("a painted segment that is hidden looks as the scan does", () => {
  expect(lookOf([{ ...painted, visible: false }]).segments).toEqual([]);
});

test("surfaces go out with their own look, and those that are not drawn do not", () => {
  const through: Segment = {
    ...bone,
    shown_as: "both",
    opacity: 0.5,
    wireframe: true,
    ambient: 0.5,
    colour: [1, 0, 0],
  };
  const { surfaces } = lookOf([through, { ...painted, shown_as: "surface", opacity: 0 }, { ...bone, id: 3 }]);
  const colour = [1, 0, 0];
  expect(surfaces).toEqual([{ id: 1, colour, opacity: 0.5, wireframe: true, ambient: 0.5, specular: bone.specular }]);
});
