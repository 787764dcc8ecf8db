import { expect, test } from "vitest";
import { newThreshold, skinThreshold } from "../../../src/core/segments/new_threshold";

const scan = { bone: 300, soft_tissue: 50, range: [-200, 2000] as const };

test("the first segment is bone, the next one all from skin upward, within the scan's values", () => {
  expect(newThreshold(scan, [])).toEqual({ name: "Bone", low: 300, high: 2000 });
  expect(newThreshold({ ...scan, range: [-1000, 2000] }, [{ range: [300, 900], made_by: null }])).toEqual({
    name: "Skin",
    low: -300,
    high: 2000,
  });
  expect(newThreshold(scan, [{ range: [300, 2000], made_by: null }]).low).toBe(-200);
  expect(newThreshold(scan, [{ range: null, made_by: null }, { range: [299, 2000], made_by: null }]).name).toBe("Bone");
  expect(skinThreshold({ ...scan, range: [-1000, 2000] })).toEqual({ name: "Skin", low: -300, high: 2000 });
  // bone out of which something was taken has no range any more
  expect(newThreshold(scan, [{ range: null, made_by: [300, 2000] }]).name).toBe("Skin");
});
