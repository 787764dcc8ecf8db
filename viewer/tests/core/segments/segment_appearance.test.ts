import { describe, expect, it } from "vitest";
import type { Segment } from "../../../src/core/protocol";
import {
  askedFor,
  changedForAll,
  changedProperties,
  commonWay,
  named,
  shownAlone,
} from "../../../src/core/segments/segment_appearance";

const bone: Segment = {
  id: 1,
  name: "Bone",
  colour: [1, 1, 1],
  visible: true,
  touched_while_hidden: false,
  touchable: true,
  felt: true,
  locked: false,
  range: null,
  made_by: null,
  voxels: 8,
  volume_ml: 1,
  pending: false,
  feel: { stiffness: null, friction_static: null, friction_kinetic: null },
  material: null,
  regions: [],
  pose: null,
  bounds: null,
  grid: null,
  steps: null,
  shown_as: "volume",
  opacity: 1,
  smoothing: 4,
  surface_from: "bits",
  wireframe: false,
  ambient: 1,
  specular: 1,
};
const leftLung: Segment = { ...bone, id: 2, name: "lung upper lobe left", shown_as: "surface" };
const rightLung: Segment = { ...bone, id: 3, name: "lung upper lobe right", visible: false };
const all = [bone, leftLung, rightLung];

describe("properties of segments", () => {
  it("changes what is asked and nothing else", () => {
    const changed = changedProperties(leftLung, { opacity: 0.5 });
    expect(changed).toMatchObject({
      type: "segment_properties",
      id: 2,
      opacity: 0.5,
      shown_as: "surface",
      visible: true,
    });
    expect(Object.keys(changed)).not.toContain("voxels");
  });

  it("asks for all only of those that differ", () => {
    const part = { shown_as: "surface" } as const;
    expect(changedForAll(all, part)).toEqual({ 1: part, 3: part });
    expect(commonWay(all)).toBeNull();
    expect(commonWay([bone, rightLung])).toBe("volume");
    expect(commonWay([])).toBeNull();
  });

  it("shows one alone, and all again where it is alone", () => {
    expect(shownAlone(all, 3)).toEqual({ 1: { visible: false }, 2: { visible: false }, 3: { visible: true } });
    const alone = all.map((segment) => ({ ...segment, visible: segment.id === 3 }));
    expect(shownAlone(alone, 3)).toEqual({ 1: { visible: true }, 2: { visible: true } });
  });

  it("finds by words in any order", () => {
    expect(named(all, "left LUNG").map(({ id }) => id)).toEqual([2]);
    expect(named(all, "  ")).toHaveLength(3);
    expect(named(all, "liver")).toEqual([]);
  });
});

describe("what is asked of the engine", () => {
  const others = [2, 3].map((id) => ({ ...bone, id }));
  const all = [bone, ...others];

  it("is one message for many, those that change alike together", () => {
    const parts = { 1: { visible: false }, 2: { visible: true }, 3: { visible: false } };
    expect(askedFor(all, parts)).toEqual([
      {
        type: "show_segments",
        changes: [
          { visible: false, shown_as: null, ids: [1, 3] },
          { visible: true, shown_as: null, ids: [2] },
        ],
      },
    ]);
  });

  it("is the properties of one alone, and of many where more than that changes", () => {
    expect(askedFor(all, { 2: { visible: false } })).toEqual([changedProperties(all[1] ?? bone, { visible: false })]);
    const types = askedFor(all, { 1: { opacity: 0.5 }, 2: { opacity: 0.5 } }).map(({ type }) => type);
    expect(types).toEqual(["segment_properties", "segment_properties"]);
    expect(askedFor(all, {})).toEqual([]);
  });
});
