/** When a table is looked for without being asked for: in a CT at rest, once for each scan. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Session } from "../../../../src/ui/state/session.svelte";
import { RemovalControl } from "../../../../src/ui/features/scan/removal_control.svelte";

let kept: Record<string, object> = {};
let sent: string[] = [];

beforeEach(() => {
  [kept, sent] = [{}, []];
  vi.useFakeTimers();
  vi.stubGlobal("navigator", { webdriver: false });
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

function opened(unit: string): { readonly removal: RemovalControl; readonly session: Session } {
  const session = {
    scan: { name: "chest", unit },
    segments: [],
    segmentWork: null,
    tableFound: null,
    tableSuggested: false,
    memory: {
      recall: (name: string, fallback: object) => ({ ...fallback, ...kept[name] }),
      keep: (name: string, value: object) => (kept[name] = value),
    },
    send: ({ type }: { readonly type: string }) => sent.push(type),
  } as unknown as Session;
  return { removal: new RemovalControl(session), session };
}

test("it is looked for once all has been at rest for a while", () => {
  const { removal } = opened("HU");
  let rests = false;
  removal.suggestOnce(() => rests);
  vi.advanceTimersByTime(60_000);
  expect(sent).toEqual([]);
  rests = true;
  vi.advanceTimersByTime(60_000);
  expect(sent).toEqual(["suggest_table"]);
});

test("in no scan but a CT, and not for a program that drives the page", () => {
  opened("").removal.suggestOnce(() => true);
  vi.stubGlobal("navigator", { webdriver: true });
  opened("HU").removal.suggestOnce(() => true);
  vi.advanceTimersByTime(60_000);
  expect(sent).toEqual([]);
});

test("who has decided is not asked again, whatever the answer was", () => {
  for (const removes of [false, true]) {
    kept = {};
    sent = [];
    const { removal, session } = opened("HU");
    session.tableSuggested = true;
    removal.decide(removes);
    expect(session.tableSuggested).toBe(false);
    expect(sent).toEqual(removes ? ["remove_table"] : []);
    opened("HU").removal.suggestOnce(() => true);
    vi.advanceTimersByTime(60_000);
    expect(sent).toHaveLength(removes ? 1 : 0);
  }
});
