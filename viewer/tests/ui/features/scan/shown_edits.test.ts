import { expect, test } from "vitest";
import { labelledBricks } from "../../../../src/core/scan/bricks";
import type { Changed, ChangedVoxels, Displaced } from "../../../../src/core/protocol";
import type { Vec3 } from "../../../../src/core/geometry/vector";
import type { LabelVolume } from "../../../../src/core/scan/voxel_change";
import type { Picture } from "../../../../src/gl/picture/picture";
import { ShownEdits } from "../../../../src/ui/features/scan/shown_edits.svelte";
import { ballSurface } from "../../../support/ball_surface";
import { scanOf, volumeOf } from "../../../support/volumes";

const dimensions: Vec3 = [12, 10, 9];
const voxels = 12 * 10 * 9;

function labelsOf(id: number): LabelVolume {
  const ids = new Uint8Array(voxels).fill(id);
  return { ids, dimensions, bricks: labelledBricks(ids, dimensions) };
}

/** Labels in a row of voxels from x on. */
function labelled(x: number, ids: readonly number[]): ChangedVoxels {
  return { low: [x, 0, 0], high: [x + 1, 1, 1], stored: null, labels: Uint8Array.from(ids) };
}

/** Labels 7 in one voxel, or a surface. */
function changed(edit: number, part: Partial<Changed> = {}): Changed {
  return { type: "changed", edit, applied: null, voxels: [labelled(1, [7])], surfaces: [], displaced: null, ...part };
}

function setUp(download: () => Promise<LabelVolume> = () => Promise.resolve(labelsOf(3))) {
  const complaints: string[] = [];
  const shown: (LabelVolume | null)[] = [];
  const volume = volumeOf(scanOf(dimensions, [1, 1, 1]), () => 0);
  const edits = new ShownEdits({ complain: (text) => complaints.push(text), download });
  const contents = {
    setLabels: (labels: LabelVolume | null) => shown.push(labels),
    changeVoxels: () => undefined,
    changeSurfaces: () => undefined,
  };
  const picture = { contents } as unknown as Picture;
  const show = (...messages: readonly Changed[]): void => {
    for (const message of messages) {
      edits.add(message, performance.now());
    }
    edits.show({ volume, bricks: volume.bricks }, picture);
  };
  return { edits, volume, picture, complaints, shown, show };
}

test("an edit that arrives while labels are on their way is in them", async () => {
  let arrive: (labels: LabelVolume) => void = () => undefined;
  const { edits, volume, picture, shown, show } = setUp(() => new Promise((resolve) => (arrive = resolve)));
  const asked = edits.showLabels(1, volume, () => picture);
  expect(edits.awaitsLabels).toBe(true);
  show(changed(1));
  // the edited voxel alone would be all that is seen of its segment
  expect(shown).toEqual([]);
  arrive(labelsOf(3));
  await asked;
  expect(edits.awaitsLabels).toBe(false);
  expect([...(shown.at(-1)?.ids.subarray(0, 3) ?? [])]).toEqual([3, 7, 3]);
});

test("of two boxes of one edit that overlap the later one holds, and both are shown at once", async () => {
  const { edits, volume, picture, show, shown } = setUp();
  await edits.showLabels(1, volume, () => picture);
  show(changed(1, { voxels: [labelled(1, [7]), labelled(2, [8]), labelled(1, [9])] }));
  expect([...(shown.at(-1)?.ids.subarray(0, 4) ?? [])]).toEqual([3, 9, 8, 3]);
});

test("an edit with a box that lies changes nothing, not even by its other boxes", async () => {
  const { edits, volume, picture, show, shown } = setUp();
  await edits.showLabels(1, volume, () => picture);
  show(changed(1, { voxels: [labelled(1, [7]), labelled(2, [8, 8])] }));
  expect([...(shown.at(-1)?.ids.subarray(0, 4) ?? [])]).toEqual([3, 3, 3, 3]);
});

test("newer labels replace those on display without a gap", async () => {
  const { edits, volume, picture, shown } = setUp();
  await edits.showLabels(1, volume, () => picture);
  const asked = edits.showLabels(2, volume, () => picture);
  expect(edits.awaitsLabels).toBe(false);
  await asked;
  expect(shown).toHaveLength(2);
});

test("labels are asked for once for each version, and wait while none are needed", async () => {
  let asked = 0;
  const { edits, volume, picture, shown } = setUp(() => {
    asked += 1;
    return Promise.resolve(labelsOf(asked));
  });
  for (const version of [4, 4, 5, 5, null, null, 5, null, 6]) {
    await edits.showLabels(version, volume, () => picture);
  }
  expect(asked).toBe(3);
  expect(shown.map((labels) => labels?.ids[0] ?? null)).toEqual([1, 2, null, 2, null, 2, 3]);
});

test("labels that no segment needs follow edits until one does", async () => {
  const { edits, volume, picture, shown, show } = setUp();
  await edits.showLabels(1, volume, () => picture);
  await edits.showLabels(null, volume, () => picture);
  show(changed(1));
  await edits.showLabels(1, volume, () => picture);
  expect([...(shown.at(-1)?.ids.subarray(0, 3) ?? [])]).toEqual([3, 7, 3]);
});

test("labels that do not arrive are told of, and asked for again at the next occasion", async () => {
  let asked = 0;
  const { edits, volume, picture, complaints, shown } = setUp(() => {
    asked += 1;
    return asked === 1 ? Promise.reject(new Error("the engine answered 500")) : Promise.resolve(labelsOf(2));
  });
  await edits.showLabels(1, volume, () => picture);
  expect(complaints).toEqual(["The segments' voxels did not arrive: the engine answered 500"]);
  await edits.showLabels(1, volume, () => picture);
  expect(shown.at(-1)?.ids[0]).toBe(2);
});

test("all edits that wait are shown in one frame, in their order; one that lies is left out", () => {
  const { edits, show, complaints } = setUp();
  const surface = ballSurface(1, [4, 4, 4], 3, 2);
  show(
    changed(1, { surfaces: [surface] }),
    changed(2, { voxels: [labelled(2, [1, 2, 3, 4, 5])] }),
    changed(3, { surfaces: [{ id: 1, whole: false, dropped: [[0, 0, 0]], patches: [] }] }),
  );
  expect(complaints).toHaveLength(1);
  expect(complaints[0]).toContain("Edit 2 cannot be shown: 5 bytes for a box of 1 voxels");
  expect(edits.lastEdit).toBe(3);
  expect(edits.sizes.get(1)?.patches).toBe(1);
  expect(edits.lastMilliseconds).toBeGreaterThanOrEqual(0);
});

test("another scan forgets the surfaces of the one before, but no edit that waits", () => {
  const { edits, show } = setUp();
  show(changed(1, { surfaces: [ballSurface(1, [4, 4, 4], 3, 2)] }));
  edits.add(changed(2, { surfaces: [ballSurface(2, [4, 4, 4], 3, 4)] }), performance.now());
  edits.clear();
  show();
  expect([...edits.sizes.keys()]).toEqual([2]);
});

test("displacements of tissue are shown with their edit, kept, and gone with the scan or without any", () => {
  const { edits, picture, complaints, show } = setUp();
  const told: (readonly number[])[][] = [];
  Object.assign(picture.contents, {
    setDisplaced: (displaced: { size: readonly number[] }[]) => told.push(displaced.map(({ size }) => size)),
  });
  const displaced = {
    origin: [0, 0, 0],
    step: [1, 1, 1],
    size: [2, 1, 1],
    moved: new Uint8Array(16),
  } satisfies Displaced;
  const behind = { ...displaced, size: [1, 1, 1], moved: new Uint8Array(8) } satisfies Displaced;
  show(changed(1), changed(2, { displaced: [displaced, behind] }), changed(3));
  const both = [
    [2, 1, 1],
    [1, 1, 1],
  ];
  expect(told).toEqual([both]);
  edits.showAll(picture);
  expect(told).toEqual([both, both]);
  // an edit that lies is not shown at all
  show(changed(4, { displaced: [displaced, { ...displaced, moved: new Uint8Array(15) }] }));
  expect(complaints).toEqual(["Edit 4 cannot be shown: 15 bytes of displacements for 2 x 1 x 1 nodes, 8 each."]);
  show(changed(5, { displaced: [] }));
  expect(told.at(-1)).toEqual([]);
  show(changed(6, { displaced: [displaced] }));
  edits.clear();
  expect(edits.displaced).toEqual([]);
});
