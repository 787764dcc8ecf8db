import { describe, expect, it } from "vitest";
import { layouts, panesOf, type Rect } from "../../../src/core/view/picture_layout";
import { circleOnSlice } from "../../../src/core/slices/slice_marks";
import { draggedWindow, firstWindow, namedWindow, windowPresets, windowsFor } from "../../../src/core/appearance/window_level";

describe("panes", () => {
  it.each(layouts)("of layout %s stand side by side inside the picture", (layout) => {
    for (const size of [{ width: 800, height: 600 }, { width: 400, height: 900 }, { width: 3, height: 3 }]) {
      const { view, viewShown, slices } = panesOf(layout, size, "axial");
      const rects = [...(viewShown ? [view] : []), ...slices.map(({ rect }) => rect)];
      for (const { x, y, width, height } of rects) {
        expect(Math.min(x, y)).toBeGreaterThanOrEqual(0);
        expect(Math.min(width, height)).toBeGreaterThanOrEqual(1);
      }
      const apart = (a: Rect, b: Rect): boolean =>
        a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
      rects.forEach((a, i) => {
        rects.slice(i + 1).forEach((b) => { expect(apart(a, b)).toBe(true); });
      });
    }
  });

  it("put one slice below the view where the picture is upright", () => {
    expect(panesOf("slice", { width: 800, height: 600 }, "coronal").slices[0]?.rect.x).toBeGreaterThan(400);
    expect(panesOf("slice", { width: 400, height: 900 }, "coronal").slices[0]?.rect.y).toBeGreaterThan(400);
  });
});

it("of one layout show each slice once, and one pane alone has the whole picture", () => {
  const size = { width: 800, height: 600 };
  for (const single of ["axial", "coronal", "sagittal", "oblique"] as const) {
    const names = panesOf("big", size, single).slices.map(({ name }) => name);
    expect(new Set(names).size).toBe(3);
    expect(names[0]).toBe(single);
    const [large, small] = panesOf("big", size, single).slices;
    expect(large?.rect.width).toBeGreaterThan(2 * (small?.rect.width ?? 0));
  }
  const alone = panesOf("four", size, "axial", "coronal");
  expect(alone.slices).toEqual([{ name: "coronal", rect: { x: 0, y: 0, ...size } }]);
  expect(alone.viewShown).toBe(false);
  expect(panesOf("slices", size, "axial", "view")).toEqual(panesOf("view", size, "axial"));
});

describe("window and level", () => {
  const histogram = { low: 0, high: 100, counts: [500, 20, 20, 20, 400, 20, 20, 20, 1, 1] };

  it("of CT begin with soft tissue, those of other scans with all but a few voxels", () => {
    expect(firstWindow({ unit: "HU", histogram, range: [0, 100] })).toEqual({ window: 400, level: 40 });
    const { window, level } = firstWindow({ unit: "", histogram, range: [0, 100] });
    expect(level - window / 2).toBe(0);
    expect(level + window / 2).toBe(80);
  });

  it("have at most nine names, by what is scanned", () => {
    const others = { histogram, range: [0, 100] as const };
    expect(windowsFor({ unit: "HU", ...others })).toBe(windowPresets);
    expect(windowPresets).toHaveLength(9);
    expect(namedWindow(windowPresets, { window: 1400, level: -500 })?.name).toBe("Lung");
    expect(namedWindow(windowPresets, { window: 1401, level: -500 })).toBeUndefined();
    const uptake = windowsFor({ unit: "SUVbw", ...others });
    expect(uptake.length).toBeLessThanOrEqual(9);
    expect(namedWindow(uptake, { window: 10, level: 5 })?.name).toBe("0 to 10");
    const [automatic, full, dark, bright] = windowsFor({ unit: "", ...others });
    expect(automatic).toMatchObject(firstWindow({ unit: "", ...others }));
    expect(full).toMatchObject({ window: 100, level: 50 });
    // both halves meet in the middle
    expect((dark?.level ?? 0) + (dark?.window ?? 0) / 2).toBe((bright?.level ?? 0) - (bright?.window ?? 0) / 2);
  });

  it("of a scan of one value are still a window", () => {
    const flat = { low: 5, high: 5, counts: [10] };
    expect(firstWindow({ unit: "", histogram: flat, range: [5, 5] }).window).toBeGreaterThan(0);
  });

  it("follow a drag: wider to the right, brighter upward, never closed", () => {
    const bone = windowPresets.find(({ name }) => name === "Bone");
    expect(bone).toMatchObject({ window: 1000, level: 400 });
    const wider = draggedWindow({ window: 300, level: 40 }, 30, 0);
    expect(wider.window).toBeCloseTo(330, 6);
    expect(draggedWindow({ window: 300, level: 40 }, 0, -30).level).toBeCloseTo(10, 6);
    expect(draggedWindow({ window: 300, level: 40 }, -1e6, 0).window).toBeGreaterThan(0);
  });
});

it("a ball shows where a slice cuts it, and fades beyond", () => {
  const plane = { right: [1, 0, 0], up: [0, 1, 0], toward: [0, 0, 1], centre: [0, 0, 0], pixel: 0.5 } as const;
  const viewport = { width: 100, height: 100 };
  const cut = circleOnSlice(plane, [5, 5, 3], 5, viewport);
  expect(cut).toMatchObject({ x: 60, y: 40, radius: 8, strength: 1 });
  const beside = circleOnSlice(plane, [5, 5, 9], 5, viewport);
  expect(beside.radius).toBe(4);
  expect(beside.strength).toBeGreaterThan(0);
  expect(beside.strength).toBeLessThan(1);
  expect(circleOnSlice(plane, [5, 5, 90], 5, viewport).strength).toBe(0);
});
