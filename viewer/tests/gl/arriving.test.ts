/**
 * A scan that is on its way: what has arrived of it is seen as it will be, all else as it was.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import type { ArrivingResult } from "./arriving_page";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchTest } from "./scenes_page";

const edge = 96;
const arrived = 24;
let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

function arriving(scan: MarchTest): Promise<ArrivingResult> {
  return browser.page.evaluate(
    ([t, planes]) => window.glTests?.arriving(t, planes) ?? Promise.reject(new Error("no page")),
    [scan, arrived] as const,
  );
}

type Side = "slice" | "view";

/**
 * Differences of two pictures in some rows, counted from the bottom, of the slice at the left or the view at the right.
 */
function off(
  one: readonly number[],
  other: readonly number[],
  side: Side,
  [from, to]: readonly [number, number],
): number[] {
  const inside = (i: number): boolean =>
    i % edge < edge / 2 === (side === "slice") && i >= edge * from && i < edge * to;
  return one.map((value, i) => Math.abs(value - (other[i] ?? 0))).filter((_, i) => inside(Math.floor(i / 4)));
}

const mean = (values: readonly number[]): number => values.reduce((sum, value) => sum + value, 0) / values.length;

// the plane where the arrived half ends is in the middle of both, a voxel is two pixels high in the slice
const own = [0, edge / 2 - 4] as const;
const border = [edge / 2 - 4, edge / 2 + 4] as const;
const standIn = [edge / 2 + 4, edge] as const;

test.each(["marble", "ball"] as const)(
  "half of a scan is seen as it will be, the rest no worse than coarsely, with no seam: %s",
  async (field) => {
    // shade is worked out again only for the whole scan
    const unshaded = { occlusion: 0, shadow: 0 };
    const { coarse, part, whole, planes, worst, links } = await arriving({
      field,
      spacing: [1, 1, 1],
      from: "A",
      stepsPerVoxel: 1,
      softTissue: 0.5,
      lighting: unshaded,
    });
    expect(planes).toEqual([16, arrived, 48]);
    for (const side of ["slice", "view"] as const) {
      // a coarse picture differs from the whole one all over
      expect(mean(off(coarse, whole, side, own))).toBeGreaterThan(0.1);
      expect(mean(off(coarse, whole, side, standIn))).toBeGreaterThan(0.1);
      expect(Math.max(...off(part, whole, side, own))).toBe(0);
      expect(mean(off(part, whole, side, standIn))).toBeGreaterThan(0);
      expect(mean(off(part, whole, side, standIn))).toBeLessThan(mean(off(coarse, whole, side, standIn)));
      // a seam would be dark or bright for all of its length: tens of grey levels
      expect(mean(off(part, whole, side, border))).toBeLessThan(mean(off(coarse, whole, side, border)) + 1);
    }
    // the coarse picture stayed until the finer one was there, drawn by the same programs
    expect(worst).toBe(1);
    expect(links).toBe(0);
  },
);
