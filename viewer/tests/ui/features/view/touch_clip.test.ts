/** Touch is cut as the picture is: the latest planes, one question at a time, and none where nobody wants it. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { ClipPlanes, FromPage, State } from "../../../../src/core/protocol";
import { frameOf } from "../../../../src/core/scan/scan_volume";
import { ClipControl } from "../../../../src/ui/features/view/clip_control.svelte";
import { TouchClip } from "../../../../src/ui/features/view/touch_clip.svelte";
import { ScanMemory } from "../../../../src/ui/state/scan_memory";
import { PageSteps } from "../../../../src/ui/state/page_steps.svelte";
import type { Session } from "../../../../src/ui/state/session.svelte";
import { scanOf } from "../../../support/volumes";

const frame = frameOf(scanOf([40, 40, 40], [1, 1, 1]));
let kept = new Map<string, string>();

beforeEach(() => {
  kept = new Map();
  vi.stubGlobal("localStorage", {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => kept.set(key, value),
  });
});

afterEach(() => {
  vi.unstubAllGlobals();
});

/** An engine that is asked and answers when it is told to. */
class Engine {
  touchClip: ClipPlanes = [];
  greetings = 1;
  readonly asked: ClipPlanes[] = [];
  private listener: (state: State) => void = () => undefined;

  onState(listener: (state: State) => void): void {
    this.listener = listener;
  }

  send(message: FromPage): void {
    if (message.type === "change_touch_clip") this.asked.push(message.planes);
  }

  tell(): void {
    this.listener({} as State);
  }

  answer(planes: ClipPlanes = this.asked.at(-1) ?? []): void {
    this.touchClip = [...planes];
    this.tell();
  }
}

function opened(): { readonly clips: ClipControl; readonly engine: Engine; readonly touch: TouchClip } {
  const engine = new Engine();
  const clips = new ClipControl(new PageSteps(() => 1), new ScanMemory(() => undefined));
  const touch = new TouchClip(engine as unknown as Session, clips);
  clips.open(frame);
  engine.tell();
  return { clips, engine, touch };
}

function drag(clips: ClipControl, millimetres: number): void {
  const [face] = clips.faces;
  if (face === undefined) throw new Error("a box has faces");
  clips.cut(face, millimetres);
}

test("while the engine follows, only the latest of a drag waits", () => {
  const { clips, engine, touch } = opened();
  expect(engine.asked).toEqual([]);
  clips.switchBox(true);
  for (const millimetres of [1, 2, 3, 4]) {
    drag(clips, millimetres);
    engine.tell();
  }
  expect(engine.asked.length).toBe(1);
  engine.answer();
  expect(engine.asked.length).toBe(2);
  engine.answer();
  engine.tell();
  expect(engine.asked.length).toBe(2);
  expect(engine.asked.at(-1)).toEqual(clips.cutting.map(({ normal, offset }) => [normal, offset]));
  expect(touch.byOthers).toBe(false);
});

test("switched off it cuts nothing, and that is remembered", () => {
  const { clips, engine, touch } = opened();
  clips.switchBox(true);
  drag(clips, 5);
  engine.tell();
  engine.answer();
  touch.switch(false);
  engine.tell();
  expect(engine.asked.at(-1)).toEqual([]);
  const again = opened();
  again.clips.switchBox(true);
  drag(again.clips, 5);
  again.engine.tell();
  expect(again.touch.on).toBe(false);
  expect(again.engine.asked).toEqual([]);
});

test("an engine that greets again is told again, and another page's planes are told of and left", () => {
  const { clips, engine, touch } = opened();
  clips.switchBox(true);
  drag(clips, 5);
  engine.tell();
  engine.answer();
  engine.greetings += 1;
  engine.touchClip = [];
  engine.tell();
  expect(engine.asked.length).toBe(2);
  engine.answer();
  engine.answer([[[0, 0, 1], 7]]);
  engine.tell();
  expect(touch.byOthers).toBe(true);
  expect(engine.asked.length).toBe(2);
  drag(clips, 6);
  engine.tell();
  expect(touch.byOthers).toBe(false);
  expect(engine.asked.length).toBe(3);
});
