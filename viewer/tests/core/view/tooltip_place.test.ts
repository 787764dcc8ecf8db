import { expect, test } from "vitest";
import { tooltipPlace } from "../../../src/core/view/tooltip_place";

const window = { width: 1000, height: 600 };
const size = { width: 100, height: 20 };

test("a tooltip stands below the middle of its owner", () => {
  const owner = { left: 480, top: 100, right: 520, bottom: 130 };
  expect(tooltipPlace(owner, 481, size, window)).toEqual({ left: 450, top: 136 });
});

test("below a wide owner it stands where the pointer is", () => {
  const owner = { left: 100, top: 100, right: 900, bottom: 130 };
  expect(tooltipPlace(owner, 200, size, window)).toEqual({ left: 150, top: 136 });
  expect(tooltipPlace(owner, null, size, window)).toEqual({ left: 450, top: 136 });
});

test("it stays in the window, and goes above where there is no room below", () => {
  const owner = { left: 980, top: 570, right: 1000, bottom: 598 };
  const { left, top } = tooltipPlace(owner, 990, size, window);
  expect(left + size.width).toBeLessThan(window.width);
  expect(top + size.height).toBeLessThan(owner.top);
});
