/**
 * Whether the CPU draws is told by the name of what draws; where a browser keeps that, by the time that a small picture
 * takes.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { cpuDraws } from "../../src/gl/base/cpu_draws";
import { openGlBrowser, type GlBrowser } from "./browser";

let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(() => browser.close());

test.each([
  ["ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)", 1, true],
  ["llvmpipe (LLVM 15.0.6, 256 bits)", 1, true],
  ["ANGLE (NVIDIA, NVIDIA GeForce RTX 3060)", 1000, false],
  ["Apple M1", 1000, false],
  ["Apple GPU", 60, true],
  ["Apple GPU", 2, false],
  ["", 60, true],
  ["Mozilla", 2, false],
])("%s that takes %i ms: on the CPU %s", (renderer, milliseconds, expected) => {
  expect(cpuDraws(renderer, () => milliseconds)).toBe(expected);
});

test("the picture that is timed is drawn", async () => {
  const { milliseconds, error, pixel } = await browser.page.evaluate(
    () => window.glTests?.timed() ?? Promise.reject(new Error("no page")),
  );
  expect(error).toBe(0);
  expect(milliseconds).toBeGreaterThan(0);
  // 128 steps on from where the pixel began, and an opaque one
  expect(pixel[3]).toBe(255);
  expect(pixel[0]).not.toBe(0);
});
