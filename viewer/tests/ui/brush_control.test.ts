/** The brush in a person's hand: what the engine is told of a stroke, and when. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { brushRange, canBePainted, firstValues, fittingBrush, paintedName, resizedBrush } from "../../src/core/brush";
import type { FromPage, Scan } from "../../src/core/protocol";
import { BrushControl } from "../../src/ui/brush_control.svelte";
import type { Session } from "../../src/ui/session.svelte";

const scan = { name: "head", spacing: [0.7, 0.7, 2], soft_tissue: 40, bone: 250.4 } as unknown as Scan;
const up = [0, 0, 1] as const;
let sent: FromPage[] = [];
let frames: (() => void)[] = [];
let kept = new Map<string, string>();

beforeEach(() => {
  sent = [];
  frames = [];
  kept = new Map();
  vi.stubGlobal("localStorage", {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => kept.set(key, value),
  });
  vi.stubGlobal("requestAnimationFrame", (act: () => void) => frames.push(act));
});

afterEach(() => {
  vi.unstubAllGlobals();
});

function taken(): BrushControl {
  const segments = [
    { id: 3, name: "plate", grid: [1], pose: null },
    { id: 4, name: "liver", grid: null, pose: null },
    { id: 5, name: "spleen", grid: null, pose: null },
  ];
  const send = (message: FromPage): unknown => sent.push(message);
  const brush = new BrushControl({ scan, segments, send } as unknown as Session);
  brush.open(scan);
  brush.arm(true);
  return brush;
}

test("points of a stroke are told once a frame, each way from where the last one ended", () => {
  const brush = taken();
  expect(brush.ready).toBe(true);
  brush.begin([0, 0, 0], up);
  expect(sent).toMatchObject([{ type: "paint", id: 4, erases: false, points: [[0, 0, 0]], radius: 5, normal: up, values: null }]);
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
  const again = taken();
  expect(again.habits).toMatchObject({ ball: true, within: true, low: 300, high: 100 });
  const other = { ...scan, name: "foot" };
  again.open(other);
  // values of one scan mean nothing in another
  expect(again.habits).toMatchObject({ ball: true, within: false, ...firstValues(other) });
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

test("what stands elsewhere than the scan's voxels cannot be painted, and new names are free", () => {
  const still = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  expect(canBePainted({ grid: null, pose: still })).toBe(true);
  expect(canBePainted({ grid: null, pose: [...still.slice(0, 3), 5, ...still.slice(4)] })).toBe(false);
  expect(paintedName(["Painted 1", "Bone"])).toBe("Painted 2");
});
