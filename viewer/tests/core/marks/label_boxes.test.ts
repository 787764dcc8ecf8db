import { describe, expect, it } from "vitest";
import { clearOfLabels, labelBox, type LabelBox } from "../../../src/core/marks/label_boxes";

const pane = { width: 400, height: 300 };

function meet(a: LabelBox, b: LabelBox): boolean {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

function placed(places: readonly { x: number; y: number }[], lines: readonly string[]): LabelBox[] {
  const taken: LabelBox[] = [];
  for (const place of places) {
    const free = clearOfLabels(place, labelBox(place, lines), taken, pane);
    taken.push(labelBox(free, lines));
  }
  return taken;
}

describe("labels of marks", () => {
  it("stay where nothing else is", () => {
    const place = { x: 50, y: 80 };
    expect(clearOfLabels(place, labelBox(place, ["12.3 mm"]), [], pane)).toEqual(place);
  });

  it("keep apart, however many stand in one place", () => {
    const taken = placed(Array.from({ length: 6 }, () => ({ x: 100, y: 150 })), ["Point 1", "a second line"]);
    for (const [i, box] of taken.entries()) {
      expect(taken.slice(i + 1).some((other) => meet(box, other))).toBe(false);
      expect(box.top).toBeGreaterThanOrEqual(0);
      expect(box.bottom).toBeLessThanOrEqual(pane.height);
    }
  });

  it("move no farther than needed", () => {
    const [, second] = placed([{ x: 100, y: 150 }, { x: 120, y: 145 }], ["12.3 mm"]);
    expect(second?.bottom).toBe(150 - 15);
  });

  it("stay where the pane has no room", () => {
    const low = { width: 400, height: 22 };
    const place = { x: 10, y: 16 };
    const box = labelBox(place, ["12.3 mm"]);
    expect(clearOfLabels(place, box, [box], low)).toEqual(place);
  });
});
