import { expect, test } from "vitest";
import { StrokeMeter, strokesTable, formatEnergy, type MeteredState } from "../../../src/core/tools/stroke_report";

function state(time: number, part: Partial<MeteredState["tool"]>, x = 0, forces: readonly number[] = []): MeteredState {
  return {
    time,
    proxy: [x, 0, 0],
    samples: forces.map((force, i) => [time - 0.001 * (forces.length - 1 - i), 0, force, 0]),
    tool: {
      ...{ kind: "drill", radius: 2, on: true, voxels: 0, volume: 0, time: 0, energy: 0, load: 0 },
      ...{ undo_bytes: 0, undo_budget: 1 },
      ...part,
    },
  };
}

test("a stroke reports what the engine counts, and the forces and the path of its own time", () => {
  const meter = new StrokeMeter();
  // before the stroke: no part of it
  meter.take(state(1, { on: false }, 0, [9, 9]));
  expect(meter.now).toBeNull();
  expect(meter.take(state(2, {}, 1, [2]))).toBeNull();
  meter.take(state(2.1, { volume: 3, time: 0.1, energy: 4000 }, 4, [0, 4, 0]));
  meter.take(state(2.2, { volume: 5, time: 0.2, energy: 6500 }, 2, [6]));
  const report = meter.take(state(2.3, { on: false, volume: 5, time: 0.2, energy: 6500 }, 2));
  expect(report).toEqual({
    number: 1,
    diameter: 4,
    volume: 5,
    time: 0.2,
    meanForce: 4,
    peakForce: 6,
    energy: 6500,
    path: 5,
  });
});

test("a stroke that met nothing has no number; a placed probe has gone no path", () => {
  const meter = new StrokeMeter();
  meter.take(state(1, {}));
  expect(meter.take(state(2, { on: false }))).toBeNull();
  meter.take(state(3, {}));
  meter.take(state(3.016, { time: 0.016, volume: 1 }, 500));
  const report = meter.take(state(3.1, { on: false, time: 0.016, volume: 1 }, 500));
  expect(report?.number).toBe(1);
  expect(report?.path).toBe(0);
});

test("strokes are a table with their units", () => {
  const report = { number: 1, diameter: 4, volume: 5.25, time: 0.2, meanForce: 4, peakForce: 6, energy: 6500, path: 5 };
  const [head, row, end] = strokesTable([report]).split("\r\n");
  expect(head).toBe(
    "stroke,burr diameter (mm),volume removed (mm3),time at work (s)," +
      "mean force (N),peak force (N),energy (mJ),path (mm)",
  );
  expect(row).toBe("1,4.00,5.250,0.20,4.000,6.000,6500.0,5.00");
  expect(end).toBe("");
  expect([formatEnergy(820), formatEnergy(12_400)]).toEqual(["820\u202fmJ", "12.4\u202fJ"]);
});
