import { expect, test } from "vitest";
import { engineObstacle, saneDrawer, wantsEngine, type ShownThings } from "../../../src/core/appearance/who_draws";

const alone: ShownThings = { connected: true, stereo: "off", second: false };

test("automatically the engine draws where the browser draws by the CPU", () => {
  expect(wantsEngine("auto", true)).toBe(true);
  expect(wantsEngine("auto", false)).toBe(false);
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
  ["stereo is shown", { stereo: "anaglyph" }],
  ["a second scan is shown", { second: true }],
])("the browser draws where %s", (obstacle, part) => {
  expect(engineObstacle({ ...alone, ...part })).toBe(obstacle);
});
