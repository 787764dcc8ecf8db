/** What is cut away: every change is a step of the page's history, in one order with marks. */
import { beforeEach, expect, test } from "vitest";
import { inProjection, lookFrom, extentOf } from "../../../../src/core/geometry/camera";
import { frameOf } from "../../../../src/core/scan/scan_volume";
import { ClipControl } from "../../../../src/ui/features/view/clip_control.svelte";
import { MarkControl } from "../../../../src/ui/features/marks/mark_control.svelte";
import { ScanMemory } from "../../../../src/ui/state/scan_memory";
import { PageSteps } from "../../../../src/ui/state/page_steps.svelte";
import { scanOf } from "../../../support/volumes";

const frame = frameOf(scanOf([40, 40, 40], [1, 1, 1]));
const extent = extentOf([[0, 0, 0], [40, 40, 40]]);
const camera = inProjection(lookFrom("A", extent, { width: 100, height: 100 }), false, extent);
let memory = new ScanMemory(() => undefined);

beforeEach(() => {
  memory = new ScanMemory(() => undefined);
});

function opened(): { readonly clips: ClipControl; readonly marks: MarkControl; readonly steps: PageSteps } {
  const steps = new PageSteps(() => 1);
  const clips = new ClipControl(steps, memory);
  const marks = new MarkControl(steps, memory);
  clips.open(frame);
  marks.open();
  return { clips, marks, steps };
}

test("a drag of a face is one step, and all of them come back in turn", () => {
  const { clips, steps } = opened();
  const [face] = clips.faces;
  if (face === undefined) throw new Error("a box has faces");
  const cutOf = (): number => clips.clip.box[face.side][face.axis];
  clips.switchBox(true);
  for (const millimetres of [2, 5, 9]) clips.cut(face, millimetres);
  steps.endGesture();
  clips.addPlane(camera);
  const offset = clips.clip.planes[0]?.offset ?? NaN;
  clips.movePlane(0, offset + 3);
  clips.movePlane(0, offset + 4);
  steps.endGesture();
  // dragged there and back: no step
  clips.movePlane(0, offset + 5);
  clips.movePlane(0, offset + 4);
  steps.endGesture();
  const seen = [];
  while (steps.canUndo) {
    seen.push([clips.clip.box.on, cutOf(), clips.clip.planes.map((plane) => plane.offset - offset)]);
    steps.undo();
  }
  expect(seen).toEqual([[true, 9, [4]], [true, 9, [0]], [true, 9, []], [true, 0, []]]);
  expect(clips.clip.box.on).toBe(false);
  while (steps.canRedo) steps.redo();
  expect([cutOf(), clips.clip.planes.length]).toEqual([9, 1]);
  // and what is remembered is what is seen
  expect(opened().clips.clip).toEqual(clips.clip);
});

test("marks and clipping are taken back in the order in which they were made", () => {
  const { clips, marks, steps } = opened();
  marks.add("point", [[1, 2, 3]]);
  clips.addPlane(camera);
  marks.add("point", [[4, 5, 6]]);
  const seen = (): readonly number[] => [marks.all.length, clips.clip.planes.length];
  steps.undo();
  expect(seen()).toEqual([1, 1]);
  steps.undo();
  expect(seen()).toEqual([1, 0]);
  steps.redo();
  expect(seen()).toEqual([1, 1]);
  steps.undo();
  // another way is taken: what was taken back is gone
  clips.switchBox(true);
  expect(steps.canRedo).toBe(false);
  steps.undo();
  steps.undo();
  expect([...seen(), clips.clip.box.on]).toEqual([0, 0, false]);
  expect(steps.canUndo).toBe(false);
});
