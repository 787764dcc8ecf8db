import { expect, test } from "vitest";
import { engineObstacle, saneDrawer, wantsEngine, type EngineReach } from "../../../src/core/drawing/who_draws";

const there: EngineReach = { connected: true, failure: null };

test("automatically the engine draws where the browser draws by the CPU", () => {
  expect(wantsEngine("auto", true)).toBe(true);
  expect(wantsEngine("auto", false)).toBe(false);
  expect(wantsEngine("auto", true, "browser")).toBe(false);
  expect([wantsEngine("browser", true), wantsEngine("engine", false)]).toEqual([false, true]);
});

test("what was kept and is no choice counts as automatic", () => {
  expect([saneDrawer("engine"), saneDrawer("other"), saneDrawer(null)]).toEqual(["engine", "auto", "auto"]);
});

test("the engine draws where it is there and its pictures come", () => {
  expect(engineObstacle(there)).toBeNull();
});

test.each<[string, Partial<EngineReach>]>([
  ["the engine is not connected", { connected: false }],
  ["not enough memory; the engine is tried again every 30\u202fs", { failure: "not enough memory" }],
])("the browser draws where %s", (obstacle, part) => {
  expect(engineObstacle({ ...there, ...part })).toBe(obstacle);
});
