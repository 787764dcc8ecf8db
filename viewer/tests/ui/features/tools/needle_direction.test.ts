/** What direction the needle is told to go in: that of the push, of the plan or of the view, and whose choice it is. */
import { expect, test } from "vitest";
import type { Camera } from "../../../../src/core/geometry/camera";
import type { Vec3 } from "../../../../src/core/geometry/vector";
import type { FromPage, State } from "../../../../src/core/protocol";
import type { NeedlePlan } from "../../../../src/core/tools/needle_plan";
import { NeedleDirectionControl } from "../../../../src/ui/features/tools/needle_direction.svelte";
import type { Session } from "../../../../src/ui/state/session.svelte";

function page(set: Vec3 | null = null) {
  const listeners: ((state: State) => void)[] = [];
  const sent: (Vec3 | null)[] = [];
  const around: { plan: NeedlePlan | null; camera: Pick<Camera, "back"> } = { plan: null, camera: { back: [0, 0, 1] } };
  const live = (direction: Vec3 | null) => ({ needle: { set_direction: direction } }) as State;
  const session = {
    live: live(set),
    greetings: 1,
    onState: (listener: (state: State) => void) => listeners.push(listener),
    send: (message: FromPage) => {
      if (message.type === "needle_direction") sent.push(message.direction);
    },
  };
  const control = new NeedleDirectionControl(session as unknown as Session, around, () => around.camera as Camera);
  const tell = (direction: Vec3 | null): void => {
    session.live = live(direction);
    listeners.forEach((listener) => { listener(session.live); });
  };
  return { control, sent, around, tell, session };
}

test("as long as nobody chooses, nothing is sent and the push counts", () => {
  const { control, sent, tell } = page();
  tell(null);
  expect(control.follows).toBe("push");
  expect(sent).toEqual([]);
});

test("a direction that a script has set is none of this page's", () => {
  const { control, sent, tell } = page([1, 0, 0]);
  tell([1, 0, 0]);
  expect(control.follows).toBeNull();
  expect(sent).toEqual([]);
});

test("along the view the direction follows the camera, away from the person", () => {
  const { control, sent, around, tell } = page();
  control.choose("view");
  tell([0, 0, -1]);
  around.camera = { back: [1, 0, 0] };
  tell([0, 0, -1]);
  tell([-1, 0, 0]);
  expect(sent).toEqual([[-0, -0, -1], [-1, -0, -0]]);
  expect(control.follows).toBe("view");
});

test("along the plan it leads from the entry to the target, and follows it; without a plan it is the push", () => {
  const { control, sent, around, tell } = page();
  around.plan = [
    [0, 0, 10],
    [0, 0, 0],
  ];
  control.choose("plan");
  around.plan = [
    [0, 10, 0],
    [0, 0, 0],
  ];
  tell([0, 0, 1]);
  tell([0, 1, 0]);
  expect(control.follows).toBe("plan");
  around.plan = null;
  tell([0, 1, 0]);
  expect(control.follows).toBe("push");
  expect(sent).toEqual([[0, 0, 1], [0, 1, 0], null]);
});

test("what another page sets counts, and is not taken back", () => {
  const { control, sent, tell } = page();
  control.choose("view");
  // the engine's own length of 1
  tell([0, 0, -1 + 1e-9]);
  tell([0, 1, 0]);
  tell([0, 1, 0]);
  expect(control.follows).toBeNull();
  expect(sent).toHaveLength(1);
});

test("an engine that was started anew is told again", () => {
  const { control, sent, tell, session } = page();
  control.choose("view");
  tell([0, 0, -1]);
  session.greetings = 2;
  tell(null);
  expect(sent).toHaveLength(2);
  expect(control.follows).toBe("view");
});
