import { expect, test } from "vitest";
import { touchHint, type TouchSituation } from "../../../src/core/touch/touch_hint";

const bone = { name: "bone", felt: true };
const idle: TouchSituation = {
  touchMode: true,
  onSurface: true,
  presses: false,
  inVain: false,
  pressure: 1,
  tool: "none",
  segments: [bone, { name: "skin", felt: false }],
};

test("the line names what can be touched, the pressure, the tool's key and the way out", () => {
  expect(touchHint(idle)).toEqual(["Press on bone to touch it", "wheel: pressure 1.0\u202fN", "Esc leaves touch"]);
  expect(touchHint({ ...idle, tool: "drill" })).toContain("X or Shift + left drills");
  expect(touchHint({ ...idle, segments: [bone, { name: "liver", felt: true }] })[0]).toBe(
    "Press on the picture to touch it",
  );
});

test("it follows the state: outside touch mode, pressing, in vain, and in the view plane", () => {
  expect(touchHint({ ...idle, touchMode: false })[0]).toBe("T: touch with the mouse");
  expect(touchHint({ ...idle, presses: true, pressure: 0.25 })).toEqual([
    "Drag to slide along",
    "wheel: pressure 0.25\u202fN",
    "release lifts off",
  ]);
  expect(touchHint({ ...idle, presses: true, inVain: true })[0]).toContain("Nothing that can be touched");
  expect(touchHint({ ...idle, onSurface: false, tool: "eraser" })).toEqual([
    "Move the mouse to move the hand",
    "wheel: in depth",
    "X erases",
    "Esc leaves touch",
  ]);
});
