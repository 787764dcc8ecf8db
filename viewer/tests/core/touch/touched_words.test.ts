import { expect, test } from "vitest";
import { touchedWords, type Places, type TouchedState } from "../../../src/core/touch/touched_words";
import type { ClipPlanes, Segment, State } from "../../../src/core/protocol";
import { segment as bone } from "../../support/volumes";

const scan = { bone: 250, slope: 1, soft_tissue: 40, spacing: [0.5, 0.5, 2], unit: "HU" } as const;
const free = {
  clutched: false,
  contact: false,
  contact_point: [0, 0, 0],
  grabbed: 0,
  matter: { model: null },
  needle: { inside: false, segment: 0 },
  normal: [0, 0, 0],
  proxy: [0, 0, 5],
  safety: { force: "on", off: null },
  touched: 0,
} as unknown as TouchedState;
const touching: TouchedState = { ...free, contact: true, normal: [0, 0, 1], touched: bone.id };

/** Air above the plane z = 0, and a value below it. */
function words(
  state: TouchedState,
  { segments = [bone], around = null, value = -1000, clip = [] }: {
    segments?: readonly Segment[];
    around?: Segment | null;
    value?: number;
    clip?: ClipPlanes;
  } = {},
): string {
  const places: Places = { valueAt: ([, , z]) => (z < 0 ? 743 : value), segmentAt: () => around };
  return touchedWords(state, { scan, segments, places, clip });
}

test("what is touched is told by its name, what it is made of, and the value behind its surface", () => {
  expect(words(touching)).toBe("bone · hard · 743\u202fHU");
  const liver: Segment = { ...bone, name: "liver", material: { preset: "liver-soft", low: [], high: [] } as never };
  expect(words(touching, { segments: [liver] })).toBe("liver · hard · 743\u202fHU");
  const deforming = { ...touching, matter: { model: "lattice" } as State["matter"] };
  expect(words(deforming, { segments: [liver] })).toBe("liver · liver soft · 743\u202fHU");
});

test("on the smooth surface, where no voxel holds the probe yet, it is the segment behind", () => {
  expect(words({ ...touching, touched: 0 }, { around: bone })).toBe("bone · hard · 743\u202fHU");
  expect(words({ ...touching, touched: 0 }, { around: { ...bone, felt: false } })).toBe("a segment");
  expect(words({ ...touching, touched: 0 })).toBe("a segment");
});

test("a segment that is not where the scan has it has no value", () => {
  const pose = [1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] as unknown as Segment["pose"];
  expect(words(touching, { segments: [{ ...bone, pose }] })).toBe("bone · hard");
  expect(words(touching, { segments: [{ ...bone, grid: pose }] })).toBe("bone · hard");
  expect(words({ ...touching, touched: 9 })).toBe("a segment");
});

test.each([
  ["waiting", "bone · hard · 743\u202fHU · held back until it is small"],
  ["ramping", "bone · hard · 743\u202fHU · force is rising"],
  ["easing", "bone · hard · 743\u202fHU · force is easing off"],
] satisfies [State["safety"]["force"], string][])("a force that is %s is told of", (force, told) => {
  expect(words({ ...touching, safety: { ...touching.safety, force } })).toBe(told);
});

test.each([
  ["not-started", "No force yet: touch is starting"],
  ["waiting", "No force until the hand comes out of the surface"],
  ["servo-late", "No force: the computer is too busy"],
  ["stopped", "No force: the session has ended"],
  ["not-finite", "No force: it could not be computed"],
] satisfies [State["safety"]["off"], string][])("no force is sent where it is %s", (off, told) => {
  for (const state of [free, touching]) {
    expect(words({ ...state, safety: { ...state.safety, force: "off", off } })).toBe(told);
  }
});

test("why nothing is felt is told of the place where the probe is", () => {
  const hidden = { ...bone, visible: false, felt: false };
  const passed = { ...bone, touchable: false, felt: false };
  expect(words(free)).toBe("Free: nothing is touched");
  expect(words(free, { around: hidden })).toBe("Free: in bone, which is hidden");
  expect(words(free, { around: passed })).toBe("Free: in bone, which lets the probe pass");
  expect(words(free, { around: { ...bone, pending: true } })).toBe("Free: in bone, which waits for the probe to leave");
  expect(words(free, { around: bone, value: 743 })).toBe("Free: nothing is touched");
  expect(words(free, { value: 743 })).toBe("Free: in bone of no segment");
  expect(words(free, { segments: [hidden] })).toBe("Free: no segment can be touched now");
  expect(words(free, { segments: [] })).toBe("Free: there is no segment to touch");
});

test("what is held, the clutch and a needle are told of", () => {
  expect(words({ ...free, grabbed: bone.id })).toBe("Holds bone: what is held is not felt");
  expect(words({ ...free, clutched: true })).toBe("Clutch: the device moves without the probe");
  const needle = (segment: number): TouchedState => ({
    ...free,
    needle: { ...free.needle, inside: true, segment },
  });
  expect(words(needle(bone.id))).toBe("Needle in bone");
  expect(words(needle(0))).toBe("Needle in no segment");
});

test("before a plane that cuts touch, the segment around is cut away", () => {
  const above: ClipPlanes = [[[0, 0, 1], 4]];
  expect(words(free, { around: bone, clip: above })).toBe("Free: in bone, which is cut away here");
  expect(words(free, { around: bone, clip: [[[0, 0, 1], 6]] })).toBe("Free: nothing is touched");
  const hidden = { ...bone, felt: false };
  expect(words(free, { around: hidden, clip: above })).toBe("Free: in bone, which is hidden");
});
