import { expect, test } from "vitest";
import { linearFromSrgb } from "../../../src/core/base/colour";
import { drawnBy } from "../../../src/core/appearance/drawn_values";
import { firstLighting, type Appearance } from "../../../src/core/appearance/appearance";
import { shadedOptics } from "../../../src/core/appearance/optics";
import type { Segment } from "../../../src/core/protocol";
import { KeepEqual } from "../../../src/core/base/keep_equal";
import {
  bodyOpacity,
  drawnAsSurface,
  drawnKey,
  drawnFromVoxels,
  mostRanges,
  rangesInside,
  showable,
  shownRanges,
  withoutRoom,
  type InsideMode,
} from "../../../src/core/segments/shown_segments";
import { segment } from "../../support/volumes";

const rescale = { slope: 1, intercept: 0 };

test.each([
  ["volume", true, false],
  ["surface", false, true],
  ["both", true, true],
] as const)("a segment shown as %s is drawn from its voxels: %s, as a surface: %s", (shown_as, voxels, surface) => {
  const shown = { ...segment, shown_as };
  expect(drawnFromVoxels(shown)).toBe(voxels);
  expect(drawnAsSurface(shown)).toBe(surface);
  expect(drawnFromVoxels({ ...shown, visible: false }) || drawnAsSurface({ ...shown, visible: false })).toBe(false);
});

test("what the picture is handed stays the same where an edit only changed numbers of voxels", () => {
  const same = new KeepEqual<readonly Segment[]>();
  const told = (part: Partial<Segment>): readonly Segment[] => {
    const segments = [{ ...segment, ...part }];
    return same.of(segments, drawnKey(segments));
  };
  const first = told({ voxels: 10 });
  expect(told({ voxels: 9, volume_ml: 3, pending: true })).toBe(first);
  const parts: readonly Partial<Segment>[] = [
    { range: null },
    { made_by: [1, 2] },
    { steps: { range: [1, 2], steps: [] } },
    { colour: [0, 0, 1] },
    { visible: false },
    { shown_as: "both" },
    { opacity: 0.5 },
    { wireframe: true },
    { ambient: 0.5 },
    { specular: 0 },
    { pose: Array.from({ length: 16 }, () => 1) },
  ];
  for (const part of parts) {
    expect(told(part)).not.toBe(first);
  }
});

test("the voxels of a segment that is a surface are left out of the picture", () => {
  const [range] = shownRanges([{ ...segment, shown_as: "surface", colour: [1, 0.5, 0] }], rescale);
  expect(range).toMatchObject({ visible: false, colour: linearFromSrgb([1, 0.5, 0]) });
});

test("as long as a surface has not arrived the voxels are drawn in its place", () => {
  const asked = { ...segment, shown_as: "surface" as const };
  expect(drawnFromVoxels(showable(asked, false, null))).toBe(true);
  expect(drawnFromVoxels(showable(asked, true, null))).toBe(false);
});

test("while a range is dragged the voxels of the new range are drawn, not the old surface", () => {
  const dragged = showable({ ...segment, shown_as: "both" }, true, [100, 200]);
  expect(dragged.range).toEqual([100, 200]);
  expect(drawnAsSurface(dragged)).toBe(false);
});

test("thresholds for which the picture has no room are told; those that were edited have labels and need none", () => {
  const many = Array.from({ length: mostRanges + 2 }, (_, id): Segment => ({
    ...segment,
    id: id + 1,
    range: [id, id],
  }));
  expect(withoutRoom(many.slice(0, mostRanges))).toEqual([]);
  expect(withoutRoom(many)).toEqual(many.slice(-2));
  const edited = many.map((one, place) => (place > mostRanges ? { ...one, range: null, made_by: one.range } : one));
  expect(withoutRoom(edited)).toEqual(edited.slice(mostRanges, -1));
});

test("a body stands for a surface that is closed and where its voxels are, as opaque as it or as these", () => {
  const surface: Segment = { ...segment, shown_as: "surface" };
  const both: Segment = { ...surface, shown_as: "both", opacity: 0.3 };
  const moved = [1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0];
  expect([bodyOpacity(surface), bodyOpacity({ ...surface, opacity: 0.9 })]).toEqual([1, 0.9]);
  expect([bodyOpacity(both), bodyOpacity(both, "tinted"), bodyOpacity(both, "plain")]).toEqual([1, 0.3, 0]);
  const others: readonly Partial<Segment>[] = [
    { opacity: 0 },
    { wireframe: true },
    { pose: moved },
    { grid: moved },
    { visible: false },
    { shown_as: "volume" },
  ];
  expect(others.map((other) => bodyOpacity({ ...surface, ...other }))).toEqual(others.map(() => 0));
});

test("what is told of a range inside of the volume has the body that stands for its surface there", () => {
  const shown = (part: Partial<Segment>, mode: InsideMode): number | undefined =>
    rangesInside(shownRanges([{ ...segment, range: [500, 600], ...part }], rescale), { [segment.id]: mode })[0]?.body;
  const both: Partial<Segment> = { shown_as: "both", opacity: 0.3 };
  expect((["solid", "tinted", "plain"] as const).map((mode) => shown(both, mode))).toEqual([1, 0.3, undefined]);
  expect(shown({ ...both, wireframe: true }, "tinted")).toBe(0);
});

test("bricks of what a body can stand for are never empty, so that it can come and go with each picture", () => {
  const appearance: Appearance = {
    transferFunction: { points: [{ value: 0, colour: [1, 1, 1], extinction: 0 }] },
    ranges: shownRanges([{ ...segment, range: [500, 600], shown_as: "surface" }], rescale),
    edgeGradient: 40,
    lighting: firstLighting,
    optics: shadedOptics,
  };
  const [bone, air] = [32768 + 550, 32768 - 900];
  expect(drawnBy(appearance, rescale).any(bone, bone)).toBe(true);
  expect(drawnBy(appearance, rescale).any(air, air)).toBe(false);
  // there voxels of segments are values like others
  expect(drawnBy({ ...appearance, optics: { ...shadedOptics, blend: "emission" } }, rescale).any(bone, bone)).toBe(
    false,
  );
});
