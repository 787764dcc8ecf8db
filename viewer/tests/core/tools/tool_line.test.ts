import { expect, test } from "vitest";
import { rodsOf, toolLine, towardHand } from "../../../src/core/tools/tool_line";
import { dot, length } from "../../../src/core/geometry/vector";
import type { State } from "../../../src/core/protocol";

const camera = { right: [1, 0, 0], up: [0, 0, 1], back: [0, -1, 0] } as const;

function held(kind: State["tool"]["kind"], part: Partial<Pick<State, "force" | "contact">> = {}, inside = false) {
  return {
    tool: {
      ...{ kind, radius: 2, on: true, voxels: 0, volume: 0, time: 0, energy: 0, load: 0 },
      ...{ undo_bytes: 0, undo_budget: 1 },
    },
    needle: {
      ...{ inside, depth: 5, segment: 1, tip: 0, friction: 0, wall: 0, events: 0, set_direction: null },
      entry: [1, 2, 3],
      direction: [0, 1, 0],
    },
    force: [0, 0, 0],
    contact: false,
    ...part,
  } as const;
}

test("a drill is held from before the picture, toward its viewer", () => {
  const axis = toolLine(held("drill"), camera, null)?.axis ?? [0, 0, 0];
  expect(length(axis)).toBeCloseTo(1, 12);
  expect(dot(axis, camera.back)).toBeGreaterThan(0.5);
  expect(axis).toEqual(towardHand(camera));
});

test("a shaft is no thicker than its burr, and balls alone have none", () => {
  expect(rodsOf("drill", 0.5)?.shaft.radius).toBeLessThan(0.5);
  expect(rodsOf("eraser", 4)).toBeNull();
  expect(toolLine(held("painter"), camera, null)).toBeNull();
});

test("a needle leads outward against its push, and in tissue along its line", () => {
  const pushed = toolLine(held("needle", { contact: true, force: [0, 0, 3] }), camera, null);
  expect(pushed?.axis).toEqual([0, 0, 1]);
  expect(pushed?.entry).toBeNull();
  const inside = toolLine(held("needle", { contact: true, force: [0, 0, 3] }, true), camera, null);
  expect(inside?.axis[1]).toBe(-1);
  expect(inside?.entry).toEqual([1, 2, 3]);
});

test("a needle outside points along the direction that was set, whatever it is pushed", () => {
  const state = held("needle", { contact: true, force: [0, 0, 3] });
  const aimed = { ...state, needle: { ...state.needle, set_direction: [1, 0, 0] } } as const;
  expect(toolLine(aimed, camera, null)?.axis[0]).toBe(-1);
  // in tissue it is on its line
  expect(toolLine({ ...aimed, needle: { ...aimed.needle, inside: true } }, camera, null)?.axis[1]).toBe(-1);
});
