import { expect, test } from "vitest";
import {
  added,
  curveOfFunction,
  extinctionOf,
  isCurve,
  moved,
  opacityOf,
  placedCurve,
  removed,
  roundStep,
  snapped,
  transferFunctionOfCurve,
  type Curve,
} from "../../../src/core/appearance/curve";
import { curveOfPreset, presets } from "../../../src/core/appearance/curve_presets";
import { readSlicerPreset } from "../../../src/core/appearance/slicer_preset";
import { bakeTransferFunction, integrateRow, sample } from "../../../src/core/appearance/transfer_function";
import { swatchOf } from "../../../src/ui/widgets/swatch";

const curve: Curve = {
  opacities: [{ value: 0, opacity: 0 }, { value: 100, opacity: 0.5 }, { value: 300, opacity: 0.9 }],
  colours: [{ value: 50, colour: "#ff0000" }, { value: 250, colour: "#0000ff" }],
};

test("the opacity of a curve is that of a millimetre, straight between its points", () => {
  const { points } = transferFunctionOfCurve(curve);
  for (const [value, opacity] of [[0, 0], [50, 0.25], [100, 0.5], [200, 0.7], [300, 0.9], [900, 0.9]] as const) {
    // short straight pieces of extinction stand for a line of opacity
    expect(Math.abs(opacityOf(sample(points, value).extinction) - opacity)).toBeLessThan(0.01);
  }
  expect(sample(points, 0).colour).toEqual([1, 0, 0]);
  expect(sample(points, 150).colour[0]).toBeCloseTo(0.5);
  expect(points.every(({ value }, i) => i === 0 || value > (points[i - 1]?.value ?? value))).toBe(true);
});

test("a function becomes a curve and the same function again at its points", () => {
  const { points } = transferFunctionOfCurve(curve);
  const again = transferFunctionOfCurve(curveOfFunction({ points })).points;
  for (const { value, extinction } of points) {
    expect(sample(again, value).extinction).toBeCloseTo(extinction, 6);
  }
  expect(extinctionOf(1)).toBeLessThan(6);
});

test("shift and scale move all of a curve about its middle", () => {
  const placed = placedCurve(curve, 10, 2);
  expect(placed.opacities.map(({ value }) => value)).toEqual([-140, 60, 460]);
  expect(placed.colours.map(({ value }) => value)).toEqual([-40, 360]);
});

test("what was kept is taken for a curve only where it is one", () => {
  expect(isCurve(JSON.parse(JSON.stringify(curve)))).toBe(true);
  const broken = [
    null,
    3,
    {},
    { ...curve, colours: [] },
    {
      ...curve,
      opacities: [
        { value: 1, opacity: 2 },
        { value: 2, opacity: 0 },
      ],
    },
  ];
  expect([...broken, { ...curve, colours: [{ value: 0, colour: "red" }, curve.colours[1]] }].filter(isCurve)).toEqual(
    [],
  );
});

test("points stay between their neighbours, and two are always left", () => {
  expect(moved(curve.opacities, 1, { value: 500 }, 5)[1]?.value).toBe(295);
  expect(moved(curve.opacities, 0, { value: -40, opacity: 0.1 }, 5)[0]).toEqual({ value: -40, opacity: 0.1 });
  const { row, at } = added(curve.opacities, { value: 200, opacity: 0 });
  expect([at, row.map(({ value }) => value)]).toEqual([2, [0, 100, 200, 300]]);
  expect(removed(row, 2)).toEqual(curve.opacities);
  expect(removed(curve.colours, 0)).toBe(curve.colours);
  expect([snapped(123, 10), roundStep(380), roundStep(1200), roundStep(0.7)]).toEqual([120, 5, 20, 0.01]);
});

test("running integrals end at the mean of a row", () => {
  const row = bakeTransferFunction({
    points: [
      { value: 0, colour: [1, 0.5, 0], extinction: 0 },
      { value: 10, colour: [1, 0.5, 0], extinction: 4 },
    ],
  });
  const last = [...integrateRow(row).slice(-4)];
  [2, 1, 0, 2].forEach((value, i) => {
    expect(last[i]).toBeCloseTo(value, 4);
  });
});

test("every preset is a curve with a swatch, in HU as written, elsewhere where soft tissue and bone are", () => {
  const hu = { softTissue: 40, bone: 250 };
  for (const preset of presets) {
    const made = curveOfPreset(preset, hu, 0, 1000);
    expect(transferFunctionOfCurve(made).points.length).toBeGreaterThan(5);
    expect(made.opacities.every(({ value }, i) => i === 0 || value > (made.opacities[i - 1]?.value ?? value))).toBe(
      true,
    );
    expect(swatchOf(made)).toMatch(/^linear-gradient\(to right, #[0-9a-f]{8} /);
  }
  const bone = presets.find(({ name }) => name === "CT-Bone");
  expect(bone && curveOfPreset(bone, hu, 0, 1).opacities[1]?.value).toBe(230);
  expect(bone && curveOfPreset(bone, { softTissue: 1064, bone: 1274 }, 0, 1).opacities[1]?.value).toBe(1254);
});

const element =
  '<VolumeProperty id="v1" name="Knee" interpolation="1" scalarOpacity="6 -100 0 50 0.25 400 1" ' +
  'gradientOpacity="4 0 1 255 1" colorTransfer="8 -100 0 0 0 400 1 0.5 0" />';

const component = {
  rgbTransferFunction: {
    type: "colorTransferFunction",
    points: [{ x: -100, color: [0, 0, 0], midpoint: 0.5, sharpness: 0 }, { x: 400, color: [1, 0.5, 0] }],
  },
  scalarOpacity: { type: "piecewiseLinearFunction", points: [{ x: -100, y: 0 }, { x: 50, y: 0.25 }, { x: 400, y: 1 }] },
};
const schema =
  "https://raw.githubusercontent.com/Slicer/Slicer/main/Modules/Loadable/VolumeRendering/Resources/Schema/" +
  "volume-property-schema-v1.0.0.json#";
const jsonOf = (told: object): string =>
  JSON.stringify({ "@schema": schema, volumeProperties: [{ components: [told] }] });

test("a volume property of Slicer is read from JSON, from its element and from a .vp file", () => {
  const expected: Curve = {
    opacities: [{ value: -100, opacity: 0 }, { value: 50, opacity: 0.25 }, { value: 400, opacity: 1 }],
    colours: [{ value: -100, colour: "#000000" }, { value: 400, colour: "#ff8000" }],
  };
  expect(readSlicerPreset(`<MRML>\n${element}\n</MRML>`)).toEqual({ name: "Knee", curve: expected });
  const lines = "1\n1\n0.9\n0.1\n0.2\n10\n6 -100 0 50 0.25 400 1\n4 0 1 255 1\n8 -100 0 0 0 400 1 0.5 0\n";
  expect(readSlicerPreset(lines).curve).toEqual(expected);
  expect(readSlicerPreset(jsonOf(component))).toEqual({ name: "Imported", curve: expected });
  const jump = readSlicerPreset(element.replace("6 -100 0 50 0.25 400 1", "8 -100 0 50 0 50 1 400 1")).curve;
  expect(jump.opacities[2]?.value).toBeGreaterThan(50);
});

test.each([
  ["", /got nothing/],
  ["1 2 3", /1 lines without one/],
  [element.replace("6 -100", "8 -100"), /scalar opacity function says 8 numbers and has 6/],
  [element.replace("0.25", "x"), /scalar opacity function holds "x", which is no number/],
  [element.replace("0.25", "1.25"), /opacity goes from 0 to 1, got 1.25/],
  [element.replace(/colorTransfer="[^"]*"/, ""), /colour transfer function is missing/],
  [element.replace("6 -100 0 50 0.25 400 1", "4 5 0 5 1"), /all its points at one value/],
  ['{"volumeProperties"', /begins as JSON and is none/],
  ['{"volumeProperties": []}', /list "volumeProperties" that is not empty/],
  ['{"volumeProperties": [{}]}', /list "components" that is not empty/],
  [
    jsonOf({ ...component, scalarOpacity: { points: [{ x: 1, y: 1 }] } }),
    /at least two points as scalarOpacity.points/,
  ],
  [
    jsonOf({ ...component, rgbTransferFunction: { points: [{ x: 1, color: [1, 1] }, {}] } }),
    /point 1 of the colour transfer function needs 4 numbers/,
  ],
  [
    jsonOf({ ...component, scalarOpacity: { points: [{ x: 1, y: 2 }, { x: 2, y: 1 }] } }),
    /opacity goes from 0 to 1, got 2/,
  ],
  ["x".repeat(200_001), /at most 200000 characters/],
])("what is no preset is refused with the reason: %.60s", (text, reason) => {
  expect(() => readSlicerPreset(text)).toThrow(reason);
});
