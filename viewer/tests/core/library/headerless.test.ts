/** What a person tells of files without a layout: its words for the engine, and what is kept of it. */
import { expect, test } from "vitest";
import {
  layoutText,
  likelyOf,
  wholeVoxel,
  withLayout,
  type HeaderlessFiles,
  type RawLayout,
} from "../../../src/core/library/headerless";

const layout: RawLayout = { columns: 256, rows: 128, slices: null, kind: "int16", order: "big", skip: 0 };
const raw: HeaderlessFiles = {
  find: 1,
  name: "head",
  files: 113,
  bytes: 113 * 65536,
  layout,
  size: null,
  voxel: [null, null, null],
};
const pictures: HeaderlessFiles = { ...raw, layout: null, size: [256, 128, 113], voxel: [0.5, 0.5, null] };

test("a layout is told as the command line takes it", () => {
  expect(layoutText(layout)).toBe("256x128,int16,big,0");
  expect(layoutText({ ...layout, slices: 9, order: "little", skip: 52 })).toBe("256x128x9,int16,little,52");
});

test("a voxel has three edges above 0, or is not told yet", () => {
  expect(wholeVoxel([1, 1, 2])).toEqual([1, 1, 2]);
  expect(wholeVoxel([1, null, 2])).toBeNull();
  expect(wholeVoxel([1, 0, 2])).toBeNull();
});

test("what was told of such files is likely of them the next time", () => {
  const told = { layout: { ...layout, order: "little" as const }, voxel: [1, 1, 2] as const };
  expect(likelyOf(raw, { layouts: [] })).toEqual({ layout, voxel: raw.voxel });
  const kept = withLayout({ layouts: [] }, raw, told);
  // more slices of the same size
  expect(likelyOf({ ...raw, files: 60, bytes: 60 * 65536 }, kept)).toEqual(told);
  expect(likelyOf({ ...raw, files: 60, bytes: 60 * 65538 }, kept).layout).toEqual(layout);
  expect(likelyOf(pictures, kept).voxel).toEqual([0.5, 0.5, null]);
  const both = withLayout(kept, pictures, { layout: null, voxel: [0.5, 0.5, 3] });
  expect(likelyOf(pictures, both).voxel).toEqual([0.5, 0.5, 3]);
  expect(both.layouts).toHaveLength(2);
  expect(withLayout(both, raw, told).layouts).toHaveLength(2);
});
