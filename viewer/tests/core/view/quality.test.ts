import { expect, test } from "vitest";
import { firstQuality, qualities, restingPictures, saneQuality } from "../../../src/core/view/quality";

test("each quality averages more pictures than the one before, of no fewer steps", () => {
  const pictures = qualities.map((quality) => restingPictures[quality]);
  pictures.slice(1).forEach(({ stepsPerVoxel, passes }, i) => {
    expect(stepsPerVoxel).toBeGreaterThanOrEqual(pictures[i]?.stepsPerVoxel ?? Infinity);
    expect(passes).toBeGreaterThan(pictures[i]?.passes ?? Infinity);
  });
});

test("what was kept and is no choice is as it is at first", () => {
  const first = firstQuality(false);
  expect(first.quality).toBe("balanced");
  expect(saneQuality({ quality: "still", frameBudget: 16 }, first)).toEqual({ quality: "still", frameBudget: 16 });
  const broken = { quality: "finest", frameBudget: "soon" } as unknown as typeof first;
  expect(saneQuality(broken, first)).toEqual(first);
  expect(saneQuality({ quality: "fine", frameBudget: 0 }, first)).toEqual({ quality: "fine", frameBudget: 33 });
});
