import { expect, test } from "vitest";
import { brickRanges, labelledBricks } from "../../../src/core/scan/bricks";
import type { ChangedVoxels } from "../../../src/core/protocol";
import type { ScanVolume } from "../../../src/core/scan/scan_volume";
import type { Vec3 } from "../../../src/core/geometry/vector";
import { ChangeError, decodeVoxels, updateBricks, updateLabels, writeBox } from "../../../src/core/scan/voxel_change";
import { Random } from "../../support/random";
import { scanOf, volumeOf } from "../../support/volumes";

const dimensions: Vec3 = [21, 17, 26];

/** An edit of a box; the stored value and the label of each voxel are given. */
function change(low: Vec3, high: Vec3, stored: (voxel: Vec3) => number, label: (voxel: Vec3) => number): ChangedVoxels {
  const voxels: Vec3[] = [];
  for (let z = low[2]; z < high[2]; ++z) {
    for (let y = low[1]; y < high[1]; ++y) {
      for (let x = low[0]; x < high[0]; ++x) {
        voxels.push([x, y, z]);
      }
    }
  }
  const values = Int16Array.from(voxels, stored);
  return { low, high, stored: new Uint8Array(values.buffer), labels: Uint8Array.from(voxels, label) };
}

const before = (): number => -7;
const after = ([x, y, z]: Vec3): number => 1000 - x - 30 * y - 900 * z;
const boxes: readonly (readonly [Vec3, Vec3])[] = [
  [[0, 0, 0], [21, 17, 26]],
  [[3, 5, 7], [4, 6, 8]],
  [[7, 8, 15], [17, 16, 17]],
  [[20, 16, 25], [21, 17, 26]],
];

test.each([1, 2, 3].flatMap((step) => boxes.map(([low, high]) => [step, low, high] as const)))(
  "every %d. voxel of the box %j to %j changes, and no other",
  (step, low, high) => {
    const scan = scanOf(dimensions, [1, 1, 1]);
    const inside = (centre: Vec3): boolean => centre.every((c, axis) => (low[axis] ?? 0) < c && c < (high[axis] ?? 0));
    const voxelAt = (centre: Vec3): Vec3 => [centre[0] - 0.5, centre[1] - 0.5, centre[2] - 0.5];
    const volume = volumeOf(scan, before, step);
    const expected = volumeOf(scan, (centre) => (inside(centre) ? after(voxelAt(centre)) : -7), step);

    const changed = decodeVoxels(change(low, high, after, () => 0), volume);
    if (changed !== null && changed.values !== null) {
      writeBox(volume.values, volume.dimensions, changed.box, changed.values);
      updateBricks(volume.bricks, volume, changed.box);
    }
    expect(volume.values).toEqual(expected.values);
    // found again for the bricks of the box alone, as from the whole scan
    expect(volume.bricks).toEqual(expected.bricks);
  },
);

test("a box between the voxels that are held changes nothing", () => {
  const volume = volumeOf(scanOf(dimensions, [1, 1, 1]), before, 4);
  expect(decodeVoxels(change([1, 1, 1], [4, 4, 4], after, () => 1), volume)).toBeNull();
});

test("a box without values and labels changes no voxel", () => {
  const volume = volumeOf(scanOf(dimensions, [1, 1, 1]), before);
  const empty = { ...change([0, 0, 0], [3, 3, 3], after, () => 0), stored: null, labels: null };
  expect(decodeVoxels(empty, volume)).toBeNull();
});

test("after many random edits bricks are those of the whole scan", () => {
  const random = new Random(43);
  const volume = volumeOf(scanOf(dimensions, [1, 1, 1]), before);
  const ids = new Uint8Array(volume.values.length);
  const labels = { ids, dimensions, bricks: labelledBricks(ids, dimensions) };
  for (let i = 0; i < 60; ++i) {
    const ends = dimensions.map((n) => [random.whole(0, n), random.whole(0, n)].sort((a, b) => a - b));
    const end = (which: 0 | 1): Vec3 => [ends[0]?.[which] ?? 0, ends[1]?.[which] ?? 0, ends[2]?.[which] ?? 0];
    // labels come and go
    const changed = change(end(0), end(1), () => random.whole(-2000, 3000), () => random.whole(-3, 1) + 3 * (i % 2));
    const voxels = decodeVoxels(changed, volume);
    if (voxels !== null && voxels.values !== null && voxels.labels !== null) {
      writeBox(volume.values, dimensions, voxels.box, voxels.values);
      updateBricks(volume.bricks, volume, voxels.box);
      updateLabels(labels, voxels.box, voxels.labels);
    }
  }
  expect(volume.bricks).toEqual(brickRanges(volume));
  expect(labels.bricks).toEqual(labelledBricks(labels.ids, dimensions));
});

function refused(lie: Partial<ChangedVoxels>): () => unknown {
  const volume: ScanVolume = volumeOf(scanOf(dimensions, [1, 1, 1]), before);
  return () => decodeVoxels({ ...change([1, 2, 3], [4, 5, 6], after, () => 1), ...lie }, volume);
}

test.each([
  ["values that are missing", { stored: new Uint8Array(52) }, "52 bytes for a box of 27 voxels, 2 each"],
  ["labels too many", { labels: new Uint8Array(28) }, "28 bytes for a box of 27 voxels, 1 each"],
  ["a box outside of the scan", { high: [4, 5, 27] as Vec3 }, "its box is 1, 2, 3 to 4, 5, 27"],
  ["a box before the scan", { low: [-1, 2, 3] as Vec3 }, "allowed: inside of 21, 17, 26"],
  ["a box turned inside out", { low: [4, 5, 7] as Vec3 }, "its box"],
])("an edit with %s is refused and says why", (_, lie, told) => {
  expect(refused(lie)).toThrow(ChangeError);
  expect(refused(lie)).toThrow(told);
});
