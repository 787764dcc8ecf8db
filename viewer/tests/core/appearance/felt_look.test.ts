import { expect, test } from "vitest";
import { feelsBone, insideBeside, lookBeside, withoutUnfelt } from "../../../src/core/appearance/felt_look";
import { firstLighting } from "../../../src/core/appearance/appearance";
import { shadedOptics, type Blend } from "../../../src/core/appearance/optics";
import { defaultSoftTissueAndBone, transferFunctionOf } from "../../../src/core/appearance/soft_tissue_and_bone";
import { sample } from "../../../src/core/appearance/transfer_function";
import type { Segment } from "../../../src/core/protocol";
import { segment as bone } from "../../support/volumes";

const scan = { bone: 250, modality: "CT", range: [-1024, 3071], soft_tissue: 40 } as const;
const anchors = { softTissue: 40, bone: 250 };
const all = { hidden: false };
const only = { hidden: true };
const raised: Segment = { ...bone, range: [700, 3071] };

function look(blend: Blend = "shaded") {
  return {
    transferFunction: transferFunctionOf(defaultSoftTissueAndBone(anchors)),
    edgeGradient: 40,
    lighting: firstLighting,
    optics: { ...shadedOptics, blend },
  };
}

/** What is drawn at a value, beside what is drawn there where nothing is touched. */
function share(value: number, segments: readonly Segment[], modes = {}): number {
  const { transferFunction } = lookBeside(look(), scan, { segments, modes, choice: all });
  return sample(transferFunction.points, value).extinction / sample(look().transferFunction.points, value).extinction;
}

test("bone that no segment holds is a grey hint as soon as bone can be touched", () => {
  for (const value of [255, 400, 1500, 3000]) {
    expect(share(value, [raised])).toBeCloseTo(0.06, 2);
  }
  const { transferFunction } = lookBeside(look(), scan, { segments: [raised], modes: {}, choice: all });
  const colourfulness = (points: typeof transferFunction.points): number => {
    const { colour } = sample(points, 300);
    return Math.max(...colour) - Math.min(...colour);
  };
  expect(colourfulness(transferFunction.points)).toBeLessThan(0.2 * colourfulness(look().transferFunction.points));
  const values = transferFunction.points.map(({ value }) => value);
  expect(values).toEqual([...values].sort((one, other) => one - other));
  expect(new Set(values).size).toBe(values.length);
});

test("softer tissue is drawn as ever, to the last step below bone", () => {
  for (const value of [-120, 0, 40, 150, 240, 245]) {
    expect(share(value, [raised])).toBeCloseTo(1, 6);
  }
});

test.each([
  ["nothing can be touched", []],
  ["bone is locked out of touch", [{ ...raised, felt: false }]],
  ["what can be touched is softer", [{ ...bone, range: [-200, 120] }]],
  ["what can be touched is told by its voxels alone", [{ ...bone, range: null, made_by: null }]],
] satisfies [string, Segment[]][])("the picture is as ever where %s", (_, segments) => {
  const first = look();
  expect(lookBeside(first, scan, { segments, modes: {}, choice: all })).toBe(first);
});

test("an edited threshold counts by what made it, and an open range of all tissue counts too", () => {
  expect(feelsBone([{ ...bone, range: null, made_by: [700, 3071] }], scan)).toBe(true);
  const steps = { range: [700, 3071], steps: [] } as const;
  expect(feelsBone([{ ...bone, range: null, made_by: null, steps }], scan)).toBe(true);
  expect(feelsBone([{ ...bone, range: [-200, 3071] }], scan)).toBe(true);
});

test("what is bone is known of CT, and taken for it where nobody knows what a scan is", () => {
  expect(feelsBone([raised], { ...scan, modality: "" })).toBe(true);
  for (const modality of ["MR", "PT", "RTDOSE"]) {
    expect(feelsBone([raised], { ...scan, modality })).toBe(false);
  }
});

test("what can be touched and looks as tissue is no hint", () => {
  for (const mode of ["tinted", "plain"] as const) {
    const modes = { [raised.id]: mode };
    expect(share(400, [raised], modes)).toBeCloseTo(0.06, 2);
    for (const value of [700, 1500, 3071]) {
      expect(share(value, [raised], modes)).toBeCloseTo(1, 6);
    }
  }
});

test("modes in which all are values draw them as ever", () => {
  for (const blend of ["mip", "minip", "average", "absorption", "emission"] as const) {
    const first = look(blend);
    for (const choice of [all, only]) {
      expect(lookBeside(first, scan, { segments: [raised], modes: {}, choice })).toBe(first);
    }
  }
});

test("only what can be touched is shown where that is wanted", () => {
  const locked = { ...bone, id: 2, felt: false };
  expect(withoutUnfelt([bone, locked], all)).toEqual([bone, locked]);
  expect(withoutUnfelt([bone, locked], only)).toEqual([bone, { ...locked, visible: false }]);
  expect(insideBeside({ 1: "tinted" }, all)).toEqual({ 1: "tinted" });
  expect(insideBeside({ 1: "tinted" }, only)).toEqual({});
  for (const blend of ["shaded", "composite", "iso"] as const) {
    const shown = lookBeside(look(blend), scan, { segments: [], modes: {}, choice: only });
    expect(shown.transferFunction.points.every(({ extinction }) => extinction === 0)).toBe(true);
    expect(shown.optics.isoValue).toBeGreaterThan(scan.range[1]);
  }
});
