/** How the scan is shown: every gesture is one step of undo, and what is remembered follows. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Scan } from "../../../../src/core/protocol";
import { anatomy, AppearanceControl } from "../../../../src/ui/features/appearance/appearance_control.svelte";
import { ScanMemory } from "../../../../src/ui/state/scan_memory";
import { PageSteps } from "../../../../src/ui/state/page_steps.svelte";
import { SliceControl } from "../../../../src/ui/features/slices/slice_control.svelte";
import { scanOf } from "../../../support/volumes";

let kept = new Map<string, string>();
let memory = new ScanMemory(() => undefined);
const scan: Scan = {
  ...scanOf([40, 40, 40], [1, 1, 1]),
  name: "head",
  unit: "HU",
  range: [-1000, 2000],
  soft_tissue: 40,
  bone: 250,
};

beforeEach(() => {
  kept = new Map();
  memory = new ScanMemory(() => undefined);
  vi.stubGlobal("localStorage", {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => kept.set(key, value),
  });
});

afterEach(() => {
  vi.unstubAllGlobals();
});

function opened() {
  const steps = new PageSteps(() => 0);
  const appearance = new AppearanceControl(steps, memory);
  const slices = new SliceControl(steps, () => null, memory);
  appearance.open(scan);
  slices.open(scan);
  return { steps, appearance, slices };
}

test("each gesture is one step, in one order, and what is remembered is what is seen", () => {
  const { steps, appearance, slices } = opened();
  const shown = (): unknown => [
    appearance.choice,
    appearance.softTissueAndBone,
    appearance.curveChoice,
    appearance.lighting,
    appearance.inside,
    slices.appearance,
  ];
  const gestures: readonly (() => void)[] = [
    () => { appearance.choose("blend", "mip"); },
    () => { [1, 2, 3].forEach(() => { appearance.drag(5, 2); }); },
    () => { appearance.choose("blend", "composite"); },
    () => { appearance.drag(5, 2); appearance.drag(3, 1); },
    () => { appearance.usePreset("CT-Bone"); },
    () => { appearance.drag(5, 2); appearance.drag(3, 1); },
    () => { [0.2, 0.4].forEach((specular) => { appearance.light({ specular }); }); },
    () => { appearance.setInside(2, "tinted"); },
    () => { slices.setWindow({ window: 1400, level: -500 }); },
    () => { [1, 2].forEach(() => { slices.dragWindow(9, 9); }); },
    () => { slices.draw({ fill: 0.5 }); slices.draw({ fill: 0.6 }); },
    () => { slices.draw({ slabMode: "largest" }); },
    () => { slices.draw({ slab: 10, slabMode: "least" }); },
    () => { appearance.reset(); },
  ];
  const states = [shown()];
  for (const gesture of gestures) {
    gesture();
    steps.endGesture();
    states.push(shown());
  }
  for (const before of states.slice(0, -1).reverse()) {
    steps.undo();
    expect(shown()).toEqual(before);
    const next = opened();
    expect([next.appearance.choice, next.appearance.curveChoice, next.slices.appearance]).toEqual([
      appearance.choice,
      appearance.curveChoice,
      slices.appearance,
    ]);
  }
  expect(steps.canUndo).toBe(false);
  for (const after of states.slice(1)) {
    steps.redo();
    expect(shown()).toEqual(after);
  }
  expect(appearance.curveChoice.name).toBe(anatomy);
});

test("how the picture is divided is no step", () => {
  const { steps, slices } = opened();
  slices.change({ layout: "four" });
  expect(steps.canUndo).toBe(false);
  expect(opened().slices.habits.layout).toBe("four");
});

test("the look is reset with its mode", () => {
  const { appearance } = opened();
  const first = appearance.choice;
  appearance.choose("blend", "composite");
  appearance.reset();
  expect(appearance.choice).toEqual(first);
});
