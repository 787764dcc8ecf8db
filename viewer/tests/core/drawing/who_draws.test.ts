import { expect, test } from "vitest";
import { engineObstacle, saneDrawer, wantsEngine, type ShownThings } from "../../../src/core/drawing/who_draws";
import { segment } from "../../support/volumes";

const alone: ShownThings = {
  connected: true,
  failure: null,
  second: null,
  deforming: false,
  segments: [],
};

test("automatically the engine draws where the browser draws by the CPU", () => {
  expect(wantsEngine("auto", true)).toBe(true);
  expect(wantsEngine("auto", false)).toBe(false);
  expect(wantsEngine("auto", true, "browser")).toBe(false);
  expect([wantsEngine("browser", true), wantsEngine("engine", false)]).toEqual([false, true]);
});

test("what was kept and is no choice counts as automatic", () => {
  expect([saneDrawer("engine"), saneDrawer("other"), saneDrawer(null)]).toEqual(["engine", "auto", "auto"]);
});

test("the engine draws a scan, with segments and surfaces of any kind", () => {
  expect(engineObstacle(alone)).toBeNull();
});

test.each<[string, Partial<ShownThings>]>([
  ["the engine is not connected", { connected: false }],
  ["not enough memory; the engine is tried again every 30 s", { failure: "not enough memory" }],
  ["two scans are shown by turns", { second: "checkerboard" }],
  ["two scans are shown by turns", { second: "flicker" }],
  [
    "a surface is shown while soft tissue is deformed",
    { deforming: true, segments: [{ ...segment, visible: true, shown_as: "surface" }] },
  ],
])("the browser draws where %s", (obstacle, part) => {
  expect(engineObstacle({ ...alone, ...part })).toBe(obstacle);
});

test("a second scan through the first is no obstacle", () => {
  expect(engineObstacle({ ...alone, second: "blend" })).toBeNull();
});
