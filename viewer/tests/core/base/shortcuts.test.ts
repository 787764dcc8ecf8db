/** Keys as the browser tells them, of keyboards of several layouts. */
import { expect, test } from "vitest";
import { shortcutsOf, showsLatin, shownShortcut } from "../../../src/core/base/shortcuts";

type Held = Partial<Record<"altKey" | "ctrlKey" | "metaKey" | "shiftKey", boolean>>;

const press = (key: string, held: Held & { readonly code?: string; readonly latin?: boolean } = {}) =>
  shortcutsOf(
    { key, code: "", altKey: false, ctrlKey: false, metaKey: false, shiftKey: false, ...held },
    held.latin ?? true,
  );

test("letters mean the same in both cases, and Shift means something only where nothing else does", () => {
  expect(press("f")).toEqual(["F"]);
  expect(press("G", { shiftKey: true })).toEqual(["Shift+G", "G"]);
  expect(press("?", { shiftKey: true })).toEqual(["Shift+?", "?"]);
  expect(press("Escape")).toEqual(["Esc"]);
  expect(press("Enter")).toEqual(["Enter"]);
});

test("with Ctrl or Command a key means that alone", () => {
  expect(press("z", { ctrlKey: true })).toEqual(["Ctrl+Z"]);
  expect(press("Z", { metaKey: true, shiftKey: true })).toEqual(["Ctrl+Shift+Z"]);
});

test("a Latin letter is the one that is written on the key, wherever that is", () => {
  expect(press("z", { code: "KeyY" })).toEqual(["Z"]);
  expect(press("a", { code: "KeyQ", ctrlKey: true })).toEqual(["Ctrl+A"]);
});

test.each(["\u044f", "\u0396", "\u05d6", "\u314b", "Process"])("%s stands where another keyboard has a Z", (key) => {
  expect(press(key, { code: "KeyZ" })).toEqual(["Z"]);
  expect(press(key, { code: "KeyZ", ctrlKey: true, shiftKey: true })).toEqual(["Ctrl+Shift+Z"]);
});

test("signs on a keyboard of other letters are those of their places", () => {
  expect(press("\u0445", { code: "BracketLeft" })).toEqual(["["]);
  // Greek has a semicolon there, which is known once another letter was pressed
  expect(press(";", { code: "KeyQ", latin: false })).toEqual(["Q"]);
  expect(press(";", { code: "KeyQ", latin: true })).toEqual([";"]);
});

test("digits are those of their places, also where they need Shift", () => {
  expect(press("&", { code: "Digit1" })).toEqual(["1", "&"]);
  expect(press("1", { code: "Digit1", shiftKey: true })).toEqual(["Shift+1", "1", "Shift+1", "1"]);
  expect(press("?", { code: "Digit7", shiftKey: true })[0]).toBe("Shift+?");
  expect(press("4", { code: "Numpad4" })).toEqual(["4"]);
});

test("with Alt a letter means nothing, and a sign itself", () => {
  expect(press("d", { code: "KeyD", altKey: true })).toEqual([]);
  expect(press("\u2202", { code: "KeyD", altKey: true })).toEqual([]);
  expect(press("[", { code: "Digit8", altKey: true, ctrlKey: true })).toEqual(["["]);
});

test("letters show the layout, other keys do not", () => {
  expect(["a", "\u00e9", "\u044f", "\u0561"].map((key) => showsLatin({ key }))).toEqual([true, true, false, false]);
  expect(["1", ";", "Shift", "Process"].map((key) => showsLatin({ key }))).toEqual([null, null, null, null]);
});

test("keys are written to be read", () => {
  expect(["Ctrl+Shift+Z", "+", "-", "F"].map(shownShortcut)).toEqual(["Ctrl + Shift + Z", "+", "\u2212", "F"]);
});
