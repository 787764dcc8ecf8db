/**
 * Pictures from Python look as the page's: what both work out of a scan is kept in one file, which the tests of
 * `python/tests/pictures` read as well. `PALPATE_WRITE=1` writes it anew.
 */
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { expect, it } from "vitest";
import type { Appearance } from "../../../src/core/appearance/appearance";
import { transferFunctionOfCurve } from "../../../src/core/appearance/curve";
import { curveOfPreset, presets } from "../../../src/core/appearance/curve_presets";
import { lookBeside } from "../../../src/core/appearance/felt_look";
import { blends, firstChoice, opticsOf } from "../../../src/core/appearance/optics";
import {
  defaultSoftTissueAndBone,
  transferFunctionOf,
  type Anchors,
} from "../../../src/core/appearance/soft_tissue_and_bone";
import type { TransferFunction } from "../../../src/core/appearance/transfer_function";
import { extentOf, firstView, inProjection, lookFrom, type Camera } from "../../../src/core/geometry/camera";
import type { Letter } from "../../../src/core/geometry/anatomy";
import type { Vec3 } from "../../../src/core/geometry/vector";
import type { Scan, Segment } from "../../../src/core/protocol";
import { brickRanges } from "../../../src/core/scan/bricks";
import { contentHull } from "../../../src/core/scan/content_hull";
import { valueAbove } from "../../../src/core/scan/histogram";
import { restingPictures } from "../../../src/core/view/quality";

const file = fileURLToPath(new URL("../../../../python/tests/pictures/as_the_page.json", import.meta.url));

const scan = { dimensions: [60, 44, 36], spacing: [1, 1.5, 2], middle: [25, 20, 18], half: [18, 16, 11] } as const;
const sizes = [[800, 600], [300, 500]] as const;
const sides: Readonly<Record<string, Letter>> = {
  anterior: "A", posterior: "P", left: "L", right: "R", superior: "S", inferior: "I",
};
const limits = [-1024, 1830.5] as const;
const anchors: readonly Anchors[] = [{ softTissue: 40, bone: 250 }, { softTissue: 31.5, bone: 77 }];

/** Points around an ellipsoid of 300 in air of -1000. */
function outline(): Vec3[] {
  const [width, height, depth] = scan.dimensions;
  const values = new Uint16Array(width * height * depth);
  let i = 0;
  for (let z = 0; z < depth; ++z) {
    for (let y = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x, ++i) {
        const place = [x, y, z].map((n, axis) => (n - (scan.middle[axis] ?? 0)) / (scan.half[axis] ?? 1));
        values[i] = place.reduce((sum, n) => sum + n * n, 0) <= 1 ? 1300 : 0;
      }
    }
  }
  const bricks = brickRanges({ values, dimensions: scan.dimensions });
  const hull = contentHull(bricks, 1, scan.spacing, (_, high) => high >= 700);
  return hull.map((point) => [point[0] * scan.spacing[0], point[1] * scan.spacing[1], point[2] * scan.spacing[2]]);
}

const rows = ({ points }: TransferFunction): unknown => points.map((p) => [p.value, p.colour, p.extinction]);

/** The function of a scan beside a threshold of bone that can be touched. */
function besideBone(transferFunction: TransferFunction, { softTissue, bone }: Anchors): TransferFunction {
  const optics = { blend: "shaded" };
  const look = { optics, transferFunction } as unknown as Omit<Appearance, "ranges">;
  const about = { bone, soft_tissue: softTissue, modality: "CT", range: limits } as unknown as Scan;
  const segments = [{ id: 1, felt: true, range: [bone, 9999] }] as unknown as readonly Segment[];
  return lookBeside(look, about, { segments, modes: {}, choice: { hidden: false } }).transferFunction;
}

function told(): unknown {
  const points = outline();
  const extent = extentOf(points);
  const shown = ([width, height]: readonly [number, number]): Record<string, Camera> => {
    const viewport = { width, height };
    const named = Object.entries(sides).map(([name, letter]) => [name, lookFrom(letter, extent, viewport)] as const);
    const first = firstView(extent, viewport);
    return { ...Object.fromEntries(named), first, orthographic: inProjection(first, true, extent) };
  };
  const counts = [5000, 0, 40, 7, 3, 1, 0, 1];
  return {
    scan,
    outline: points,
    cameras: sizes.map((size) => ({ size, views: shown(size) })),
    brightest: [2e-4, 1e-3, 0.01].map((share) => [share, valueAbove({ low: -10, high: 30, counts }, share)]),
    histogram: { low: -10, high: 30, counts },
    limits,
    qualities: restingPictures,
    looks: anchors.map((each) => ({
      anchors: [each.softTissue, each.bone],
      tissue: rows(transferFunctionOf(defaultSoftTissueAndBone(each))),
      hinted: rows(besideBone(transferFunctionOf(defaultSoftTissueAndBone(each)), each)),
      presets: Object.fromEntries(
        presets.map((preset) => [
          preset.name,
          rows(transferFunctionOfCurve(curveOfPreset(preset, each, limits[0], limits[1]))),
        ]),
      ),
      modes: Object.fromEntries(
        blends.map((blend) => [blend, opticsOf({ ...firstChoice(each, limits[1]), blend }, each)]),
      ),
    })),
  };
}

/** Numbers that a decimal file keeps the same on every machine. */
function rounded(given: unknown): unknown {
  return JSON.parse(JSON.stringify(given), (_, value: unknown) =>
    typeof value === "number" ? Number(value.toPrecision(9)) : value,
  );
}

it("what Python works out as well is as the page does it", () => {
  const now = rounded(told());
  if (process.env["PALPATE_WRITE"] === "1") {
    writeFileSync(file, `${JSON.stringify(now)}\n`);
  }
  expect(JSON.parse(readFileSync(file, "utf8"))).toEqual(now);
});
