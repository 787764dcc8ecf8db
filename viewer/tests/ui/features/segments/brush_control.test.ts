/** The brush in a person's hand: what the engine is sent of a stroke, and when. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import {
  brushRange,
  canBePainted,
  firstValues,
  fittingBrush,
  paintedName,
  resizedBrush,
} from "../../../../src/core/segments/brush";
import type { FromPage, Outline, Scan } from "../../../../src/core/protocol";
import { BrushControl } from "../../../../src/ui/features/segments/brush_control.svelte";
import { ScanMemory } from "../../../../src/ui/state/scan_memory";
import type { Session } from "../../../../src/ui/state/session.svelte";

const scan = { name: "head", spacing: [0.7, 0.7, 2], soft_tissue: 40, bone: 250.4 } as unknown as Scan;
const up = [0, 0, 1] as const;
let sent: FromPage[] = [];
let frames: (() => void)[] = [];
let kept = new Map<string, string>();
let memory = new ScanMemory(() => undefined);

beforeEach(() => {
  sent = [];
  frames = [];
  kept = new Map();
  memory = new ScanMemory(() => undefined);
  vi.stubGlobal("localStorage", {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => kept.set(key, value),
  });
  vi.stubGlobal("requestAnimationFrame", (act: () => void) => frames.push(act));
});

afterEach(() => {
  vi.unstubAllGlobals();
});

let answer: (outline: Outline) => void = () => undefined;

function taken(): BrushControl {
  const segments = [
    { id: 3, name: "plate", grid: [1], pose: null },
    { id: 4, name: "liver", grid: null, pose: null },
    { id: 5, name: "spleen", grid: null, pose: null },
  ];
  const notify = (): void => undefined;
  const onOutline = (listener: (outline: Outline) => void): void => {
    answer = listener;
  };
  const send = (message: FromPage): unknown => sent.push(message);
  const session = { scan, segments, send, onOutline, notify, memory, greetings: 1 };
  const brush = new BrushControl(session as unknown as Session);
  brush.open(scan);
  brush.arm(true);
  return brush;
}

test("points of a stroke are told once a frame, each way from where the last one ended", () => {
  const brush = taken();
  expect(brush.ready).toBe(true);
  brush.begin([0, 0, 0], up);
  expect(sent).toMatchObject([
    { type: "paint", id: 4, erases: false, points: [[0, 0, 0]], radius: 5, normal: up, values: null },
  ]);
  brush.move([1, 0, 0]);
  brush.move([2, 0, 0]);
  expect(sent).toHaveLength(1);
  expect(frames).toHaveLength(1);
  frames.pop()?.();
  expect(sent[1]).toMatchObject({ points: [[0, 0, 0], [1, 0, 0], [2, 0, 0]] });
  brush.move([3, 0, 0]);
  brush.end();
  expect(sent.slice(2)).toMatchObject([{ points: [[2, 0, 0], [3, 0, 0]] }, { type: "end_paint", keep: true }]);
  // what comes after the end paints nothing
  frames.pop()?.();
  brush.move([4, 0, 0]);
  brush.end();
  expect(sent).toHaveLength(4);
});

test("a long way is told in messages that the engine takes", () => {
  const brush = taken();
  brush.begin([0, 0, 0], up);
  for (let x = 1; x <= 150; x += 1) brush.move([x, 0, 0]);
  brush.end();
  const ways = sent.flatMap((message) => (message.type === "paint" ? [message.points] : []));
  expect(Math.max(...ways.map((way) => way.length))).toBe(64);
  ways.slice(1).forEach((way, i) => {
    expect(way[0]).toEqual(ways[i]?.at(-1));
  });
  expect(ways.at(-1)?.at(-1)).toEqual([150, 0, 0]);
});

test("Esc takes the stroke back, then puts the brush away", () => {
  const brush = taken();
  brush.begin([0, 0, 0], up);
  brush.escape();
  expect(sent.at(-1)).toEqual({ type: "end_paint", keep: false });
  expect(brush.armed).toBe(true);
  brush.escape();
  expect(brush.armed).toBe(false);
  expect(brush.ready).toBe(false);
});

test("the engine is told of ball, values and segment as they were chosen, and they are remembered", () => {
  const brush = taken();
  brush.choose(5);
  brush.change({ ball: true, within: true, low: 300, high: 100, erases: true });
  brush.begin([0, 0, 0], up);
  expect(sent).toMatchObject([{ id: 5, erases: true, normal: null, values: [100, 300] }]);
  expect(taken().habits).toMatchObject({ ball: true, within: true, low: 300, high: 100 });
  memory = new ScanMemory(() => undefined);
  const again = taken();
  // values of one scan mean nothing in another
  expect(again.habits).toMatchObject({ ball: true, within: false, ...firstValues(scan) });
});

test("a radius covers a voxel at least and each step changes it", () => {
  const { min, max } = brushRange([0.7, 0.7, 2]);
  expect(min).toBe(1);
  expect(fittingBrush(0.1, [0.7, 0.7, 2])).toBe(min);
  let radius = min;
  for (let step = 0; step < 60; step += 1) {
    const next = resizedBrush(radius, 1, [0.7, 0.7, 2]);
    expect(next > radius || next === max).toBe(true);
    radius = next;
  }
  expect(radius).toBe(max);
  expect(resizedBrush(max, -1, [0.7, 0.7, 2])).toBeLessThan(max);
});

test("what stands elsewhere than the scan's voxels, or is locked, cannot be painted, and new names are free", () => {
  const still = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  expect(canBePainted({ grid: null, pose: still, locked: false })).toBe(true);
  expect(canBePainted({ grid: null, pose: [...still.slice(0, 3), 5, ...still.slice(4)], locked: false })).toBe(false);
  expect(canBePainted({ grid: null, pose: null, locked: true })).toBe(false);
  expect(paintedName(["Painted 1", "Bone"])).toBe("Painted 2");
});

/** The number of what was asked for last. */
function lastNumber(): number {
  const last = sent.at(-1);
  return last !== undefined && "number" in last ? last.number : NaN;
}

test("a wire goes from click to click, takes points back, and what it encloses is painted once it is closed", () => {
  const brush = taken();
  const { outline } = brush;
  brush.change({ way: "wire", within: true, low: 10, high: 20 });
  outline.click("axial", [0, 0, 0], up);
  expect(sent).toHaveLength(0);
  outline.point("axial", [5, 0, 0], up);
  expect(sent.at(-1)).toMatchObject({ type: "wire", begin: [0, 0, 0], end: [5, 0, 0], normal: up });
  // while an answer is awaited, only the newest pointer waits, and clicks in their turn
  outline.point("axial", [6, 0, 0], up);
  outline.point("axial", [7, 0, 0], up);
  outline.click("axial", [8, 0, 0], up);
  expect(sent).toHaveLength(1);
  answer({ type: "outline", number: lastNumber(), points: [[0, 0, 0], [5, 0, 0]], problem: null });
  expect(outline.preview).toHaveLength(2);
  expect(sent.at(-1)).toMatchObject({ end: [8, 0, 0] });
  answer({ type: "outline", number: lastNumber(), points: [[0, 0, 0], [4, 1, 0], [8, 0, 0]], problem: null });
  expect(outline.pieces).toHaveLength(1);
  outline.click("axial", [8, 8, 0], up);
  expect(sent.at(-1)).toMatchObject({ begin: [8, 0, 0], end: [8, 8, 0] });
  answer({ type: "outline", number: lastNumber(), points: [[8, 0, 0], [8, 8, 0]], problem: null });
  expect(outline.back()).toBe(true);
  expect(outline.pieces).toHaveLength(1);
  expect(outline.close()).toBe(true);
  expect(sent.at(-1)).toMatchObject({ begin: [8, 0, 0], end: [0, 0, 0] });
  answer({ type: "outline", number: lastNumber(), points: [[8, 0, 0], [4, 4, 0], [0, 0, 0]], problem: null });
  expect(sent.at(-1)).toMatchObject({
    type: "fill_outline",
    id: 4,
    points: [[0, 0, 0], [4, 1, 0], [8, 0, 0], [4, 4, 0], [0, 0, 0]],
    values: [10, 20],
  });
  expect(outline.drawing).toBe(false);
});

test("Esc cancels a wire first, and a point of another slice begins a new one", () => {
  const brush = taken();
  const { outline } = brush;
  brush.change({ way: "wire" });
  outline.click("axial", [0, 0, 0], up);
  outline.click("axial", [0, 0, 9], up);
  expect(outline.first).toEqual([0, 0, 9]);
  expect(sent).toHaveLength(0);
  brush.escape();
  expect([outline.drawing, brush.armed]).toEqual([false, true]);
  expect(outline.close()).toBe(false);
  expect(outline.back()).toBe(false);
});

test("a level is shown under the pointer and painted by a click", () => {
  const brush = taken();
  const { outline } = brush;
  const points = [[0, 0, 0], [1, 0, 0], [1, 1, 0]] as const;
  brush.change({ way: "level", erases: true });
  outline.point("axial", [1, 0, 0], up);
  expect(sent.at(-1)).toMatchObject({ type: "trace_level", point: [1, 0, 0] });
  answer({ type: "outline", number: lastNumber(), points: [...points], problem: null });
  expect(outline.preview).toEqual(points);
  outline.leave();
  expect(outline.preview).toEqual([]);
  outline.click("axial", [1, 0, 0], up);
  answer({ type: "outline", number: lastNumber(), points: [...points], problem: null });
  expect(sent.at(-1)).toMatchObject({ type: "fill_outline", erases: true, points, normal: up });
});
