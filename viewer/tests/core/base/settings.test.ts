/** Settings are found by their names and by usual other words. */
import { expect, test } from "vitest";
import { isMeant, settingNames, settings, settingSections } from "../../../src/core/base/settings";

const found = (typed: string): readonly string[] => settingNames.filter((name) => isMeant(settings[name], typed));

test("all settings are there where nothing is typed, each in a section that is shown", () => {
  expect(found(" ")).toEqual(settingNames);
  expect(settingNames.every((name) => settingSections.includes(settings[name].section))).toBe(true);
});

test("each setting is found by its own name", () => {
  for (const name of settingNames) {
    expect(found(settings[name].name)).toContain(name);
  }
});

test("usual other words find them too", () => {
  const words = {
    dark: "theme",
    "colour mode": "theme",
    resolution: "quality",
    GPU: "drawer",
    "graphics card": "drawer",
    fps: "frameBudget",
    anaglyph: "stereo",
    "3D glasses": "stereo",
    "side-by-side": "stereo",
    thesis: "model",
    vibration: "damping",
    "max force": "forceLimit",
    volume: "sound",
    controller: "rumble",
    trail: "path",
    latency: "diagnostics",
    "late ticks": "diagnostics",
    Hz: "diagnostics",
  };
  for (const [typed, name] of Object.entries(words)) {
    expect(found(typed), typed).toContain(name);
  }
});

test("every word must begin a word of it", () => {
  expect(found("dark thesis")).toEqual([]);
  expect(found("xyz")).toEqual([]);
});
