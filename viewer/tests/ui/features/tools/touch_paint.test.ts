/** Painting by touch: which segments the engine is sent, and that there is one to paint with first. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { FromPage, Scan, Segment, State } from "../../../../src/core/protocol";
import { BrushControl } from "../../../../src/ui/features/segments/brush_control.svelte";
import { ScanMemory } from "../../../../src/ui/state/scan_memory";
import type { Session } from "../../../../src/ui/state/session.svelte";
import { ToolHand } from "../../../../src/ui/features/tools/tool_hand.svelte";
import { TouchPaint } from "../../../../src/ui/features/tools/touch_paint.svelte";

const scan = { name: "head", spacing: [1, 1, 1], soft_tissue: 40, bone: 250 } as unknown as Scan;
let sent: FromPage[] = [];

beforeEach(() => {
  sent = [];
  vi.stubGlobal("localStorage", { getItem: () => null, setItem: () => undefined });
});

afterEach(() => {
  vi.unstubAllGlobals();
});

function segment(id: number, name: string, felt = true): Segment {
  return { id, name, felt, grid: null, pose: null } as unknown as Segment;
}

function page(segments: readonly Segment[]) {
  let told: (state: State) => void = () => undefined;
  const session = {
    scan,
    segments,
    settings: null,
    greetings: 1,
    memory: new ScanMemory(() => undefined),
    send: (message: FromPage): unknown => sent.push(message),
    notify: () => undefined,
    onState: (listener: typeof told) => (told = listener),
    onOutline: () => undefined,
  };
  const brush = new BrushControl(session as unknown as Session);
  const tool = new ToolHand(session as unknown as Session, new TouchPaint(session as unknown as Session, brush));
  const arrive = (now: readonly Segment[]): void => {
    session.segments = now;
    // what a derived value stands for is asked anew by another choice
    const newest = now.at(-1);
    if (newest !== undefined) brush.choose(newest.id);
    told({ touched: 0, tool: { kind: "none" } } as State);
  };
  return { brush, tool, arrive };
}

test("a painter without a segment to paint with asks for one, and works once it is there", () => {
  const { tool, arrive } = page([segment(1, "Bone")]);
  tool.choose("painter");
  expect(sent).toEqual([{ type: "new_segment", name: "Painted 1" }]);
  tool.press();
  expect(sent).toHaveLength(1);
  arrive([segment(1, "Bone"), segment(2, "Painted 1")]);
  expect(sent.slice(1)).toMatchObject([
    { type: "tool", kind: "painter", segments: [2, 1], depth: 2, overlaps: false },
    { type: "stroke", on: true },
  ]);
});

test("it is told how, and what is painted can be seen and touched", () => {
  const { brush, tool } = page([segment(1, "Bone"), segment(2, "Vessel", false)]);
  brush.choose(2);
  tool.choose("painter");
  expect(sent).toMatchObject([{ type: "tool", segments: [2, 1], depth: 2 }]);
  tool.paint.change({ surface: false, overlaps: true });
  expect(sent.at(-1)).toMatchObject({ depth: null, overlaps: true });
  tool.press();
  tool.release();
  expect(sent.map(({ type }) => type)).toEqual(["tool", "tool", "stroke", "stroke"]);
  tool.paint.change({ overlaps: false });
  tool.press();
  expect(sent.slice(-2)).toMatchObject([
    { type: "segment_properties", id: 2, touchable: true, visible: true },
    { type: "stroke", on: true },
  ]);
});

test("the segment that is painted with alone is nothing to paint", () => {
  const { brush, tool } = page([segment(2, "Painted 1")]);
  brush.choose(2);
  tool.choose("painter");
  tool.press();
  expect(sent).toEqual([expect.objectContaining({ type: "tool", kind: "none" })]);
  expect(tool.pressed).toBe(false);
});
