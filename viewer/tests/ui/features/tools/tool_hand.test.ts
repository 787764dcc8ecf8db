/** The tool in the hand of a page that was loaded anew: the engine's, and the probe's radius is given back. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { FromPage, Scan, Segment, Settings, State, ToolKind } from "../../../../src/core/protocol";
import type { Session } from "../../../../src/ui/state/session.svelte";
import { ScanMemory } from "../../../../src/ui/state/scan_memory";
import { ToolHand } from "../../../../src/ui/features/tools/tool_hand.svelte";
import type { TouchPaint } from "../../../../src/ui/features/tools/touch_paint.svelte";

const scan = { name: "head", spacing: [1, 1, 1] } as unknown as Scan;
const segments = [{ id: 1, name: "Bone", felt: true, locked: false, grid: null, pose: null }];
let stored: Map<string, string>;

beforeEach(() => {
  stored = new Map();
  vi.stubGlobal("localStorage", {
    getItem: (name: string) => stored.get(name) ?? null,
    setItem: (name: string, value: string) => stored.set(name, value),
  });
});

afterEach(() => {
  vi.unstubAllGlobals();
});

/** A page that has just been loaded, while the engine has a tool and a radius of the probe [mm]. */
function loaded(engine: { tool: ToolKind; radius: number }) {
  let told: (state: State) => void = () => undefined;
  const settings = { probe_radius: engine.radius };
  const sent: FromPage[] = [];
  const memory = new ScanMemory((message) => sent.push(message));
  const session = {
    scan,
    segments,
    memory,
    settings: settings as Settings,
    greetings: 1,
    send: (message: FromPage) => sent.push(message),
    notify: () => undefined,
    changeSettings: (part: Partial<Settings>) => Object.assign(settings, part),
    onState: (listener: typeof told) => (told = listener),
  };
  const paint = { onChange: () => undefined, ready: false };
  const tool = new ToolHand(session as unknown as Session, paint as unknown as TouchPaint);
  told({ touched: 1, tool: { kind: engine.tool } } as State);
  return { tool, settings, sent, memory };
}

test("a page that is loaded anew has the engine's tool in its hand", () => {
  expect(loaded({ tool: "drill", radius: 0 }).tool.kind).toBe("drill");
  expect(loaded({ tool: "none", radius: 0 }).tool.kind).toBe("none");
});

test("the probe gets its radius back with the next scan, and after a reload once the drill is put away", () => {
  const first = loaded({ tool: "none", radius: 0.5 });
  first.tool.choose("drill");
  const { probe_radius: burr } = first.settings;
  expect(burr).toBeGreaterThan(0.5);
  // loaded anew while it is drilled
  const again = loaded({ tool: "drill", radius: burr });
  expect(again.settings.probe_radius).toBe(burr);
  // another scan, with a session of its own
  expect(loaded({ tool: "none", radius: burr }).settings.probe_radius).toBe(0.5);
  again.tool.choose("none");
  expect(again.settings.probe_radius).toBe(0.5);
});

test("a tool that finds nothing to work on takes the place of the one before it", () => {
  const { tool, sent } = loaded({ tool: "none", radius: 0 });
  tool.choose("drill");
  tool.choose("needle");
  expect(sent.map((message) => (message.type === "tool" ? message.kind : message.type))).toEqual(["drill", "none"]);
  expect(tool.press()).toBe(true);
  expect(sent).toHaveLength(2);
});

test("what a segment is to a needle is kept with its scan: another's segment of that name is not it", () => {
  const { tool, memory, sent } = loaded({ tool: "none", radius: 0 });
  const bone = { id: 1, name: "Bone" } as Segment;
  const likely = tool.layerOf(bone);
  expect(likely).not.toBe("liver");
  tool.setLayer(bone, "liver");
  expect(tool.layerOf(bone)).toBe("liver");
  expect(sent.filter(({ type }) => type === "keep")).toHaveLength(1);
  expect([...stored.keys()].filter((key) => key.includes("needle"))).toEqual([]);
  // a page that is opened, and then another scan
  const [kept] = Object.entries(memory.everything);
  memory.greet([]);
  expect(tool.layerOf(bone)).toBe(likely);
  memory.greet([{ name: kept?.[0] ?? "", version: 1, value: JSON.stringify(kept?.[1]) }]);
  expect(tool.layerOf(bone)).toBe("liver");
});
