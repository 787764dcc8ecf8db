import { expect, test } from "vitest";
import { engineObstacle, saneDrawer, wantsEngine, type ShownThings } from "../../../src/core/appearance/who_draws";
import { segment } from "../../support/volumes";

const alone: ShownThings = { connected: true, stereo: "off", second: false, segments: [] };

test("automatically the engine draws where the browser draws by the CPU", () => {
  expect(wantsEngine("auto", true)).toBe(true);
  expect(wantsEngine("auto", false)).toBe(false);
  expect([wantsEngine("browser", true), wantsEngine("engine", false)]).toEqual([false, true]);
});

test("what was kept and is no choice counts as automatic", () => {
  expect([saneDrawer("engine"), saneDrawer("other"), saneDrawer(null)]).toEqual(["engine", "auto", "auto"]);
});

test("the engine draws a scan with segments of voxels and opaque surfaces", () => {
  const opaque = { ...segment, visible: true, shown_as: "both" as const, opacity: 1, wireframe: false };
  expect(engineObstacle({ ...alone, segments: [segment, opaque] })).toBeNull();
});

test.each<[string, Partial<ShownThings>]>([
  ["the engine is not connected", { connected: false }],
  ["stereo is shown", { stereo: "anaglyph" }],
  ["a second scan is shown", { second: true }],
  ["a segment was moved", { segments: [{ ...segment, visible: true, pose: Array<number>(16).fill(0) }] }],
  [
    "a surface is translucent or a wireframe",
    { segments: [{ ...segment, visible: true, shown_as: "surface", opacity: 0.5 }] },
  ],
])("the browser draws where %s", (obstacle, part) => {
  expect(engineObstacle({ ...alone, ...part })).toBe(obstacle);
});

test("what is hidden is no obstacle", () => {
  const hidden = { ...segment, visible: false, shown_as: "surface" as const, opacity: 0.5, pose: [1] };
  expect(engineObstacle({ ...alone, segments: [hidden] })).toBeNull();
});
