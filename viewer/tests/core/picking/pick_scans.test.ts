import { expect, test } from "vitest";
import { firstLighting, type Appearance } from "../../../src/core/appearance/appearance";
import { shadedOptics } from "../../../src/core/appearance/optics";
import { pickScans, type DrawnSecond } from "../../../src/core/picking/pick_scans";
import { nothingElse } from "../../../src/core/picking/pick_surface";
import type { SecondAppearance } from "../../../src/core/second/second_scan";
import { tissueName } from "../../../src/core/picking/tissue_name";
import type { TransferFunction } from "../../../src/core/appearance/transfer_function";
import type { Vec3 } from "../../../src/core/geometry/vector";
import { scanOf, volumeOf } from "../../support/volumes";

// slabs of bone in air, 40 mm cubes: the first's from y = 20 on, the second's of its own from y = 4 on
const scan = scanOf([40, 40, 40], [1, 1, 1]);
const first = volumeOf(scan, ([, y]) => (y >= 20 ? 500 : -1000));
const second = volumeOf(scan, ([, y]) => (y >= 4 ? 300 : -1000));
const bone: TransferFunction = {
  points: [
    { value: 100, colour: [1, 1, 1], extinction: 0 },
    { value: 300, colour: [1, 1, 1], extinction: 5 },
    { value: 900, colour: [1, 1, 1], extinction: 5 },
  ],
};
const appearance: Appearance = {
  transferFunction: bone,
  ranges: [],
  edgeGradient: 40,
  lighting: { ...firstLighting, edges: 0 },
  optics: shadedOptics,
};
const grey = { window: 400, level: 40 };
const beside: SecondAppearance = {
  inView: true,
  inSlices: true,
  viewFusion: "blend",
  transferFunction: bone,
  density: 1,
  edgeGradient: 40,
  isoValue: 200,
  tissueFrom: -300,
  windows: { mip: grey, minip: grey, average: grey },
  window: grey,
  fusion: "blend",
  tint: "grey",
  opacity: 1,
  square: 10,
  lines: [],
  turn: "second",
};
/** Laid 10 mm towards +y: its bone begins at y = 14 of the first. */
const place = [1, 0, 0, 0, 0, 1, 0, -10, 0, 0, 1, 0];

function pick(
  part: Partial<SecondAppearance>,
  at: Vec3 = [15, -50, 15],
  optics: Partial<Appearance["optics"]> = {},
): readonly [string, number, number] | null {
  const drawn: DrawnSecond = { volume: second, place, appearance: { ...beside, ...part } };
  const picked = pickScans(
    first,
    { ...appearance, optics: { ...appearance.optics, ...optics } },
    { origin: at, direction: [0, 1, 0] },
    nothingElse,
    drawn,
  );
  return picked && [picked.scan, picked.point[1], picked.value];
}

test("of two scans the nearer one is picked, where its transform puts it", () => {
  const [which, y, value] = pick({}) ?? ["", 0, 0];
  expect(which).toBe("second");
  expect(Math.abs(y - 14)).toBeLessThan(1);
  expect(value).toBeGreaterThan(100);
  // outside of the first scan, where only the second is
  expect(pick({}, [15, 100, 15])).toBeNull();
  expect(Math.abs((pick({}, [15, 43, 15])?.[1] ?? 0) - 43)).toBeLessThan(1);
});

test("what is not shown, or has nothing of its own there, is not picked", () => {
  for (const part of [{ inView: false }, { density: 0 }, { viewFusion: "flicker", turn: "first" }] as const) {
    const [which, y] = pick(part) ?? ["", 0];
    expect(which).toBe("first");
    expect(Math.abs(y - 20)).toBeLessThan(1);
  }
  expect(pick({ viewFusion: "flicker" })?.[0]).toBe("second");
  expect(pick({}, [15, -50, 15], { blend: "mip" })?.[0]).toBe("first");
});

test("in a checkerboard the scan is picked whose cell is met", () => {
  // cells of 10 mm: at x and z of the same parity the first's are those of even y
  const [which, y] = pick({ viewFusion: "checkerboard" }) ?? ["", 0];
  expect(which).toBe("second");
  expect(Math.abs(y - 14)).toBeLessThan(1);
  const [other, deeper] = pick({ viewFusion: "checkerboard" }, [25, -50, 15]) ?? ["", 0];
  expect(other).toBe("second");
  expect(Math.abs(deeper - 20)).toBeLessThan(1);
  expect(pick({ viewFusion: "checkerboard" }, [15, 20.05, 15])?.[0]).toBe("first");
});

test("values of a CT have the names of tissues, those of others tell what is bright", () => {
  const ct = { unit: "HU", soft_tissue: 40, bone: 250 };
  expect([-1000, -800, -100, 0, 60, 250, 1200].map((value) => tissueName(value, ct))).toEqual([
    "air",
    "lung",
    "fat",
    "fluid",
    "soft tissue",
    "bone",
    "bone",
  ]);
  const mr = { unit: "", soft_tissue: 100, bone: 160 };
  expect([10, 100, 200].map((value) => tissueName(value, mr))).toEqual(["dark", "tissue", "bright tissue"]);
});
