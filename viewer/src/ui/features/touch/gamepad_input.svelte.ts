/**
 * A gamepad, where there is one: its sticks move the hand and turn the picture, its motors
 * let contact be felt. Without a gamepad nothing runs.
 */
import { orbit, type Camera } from "../../../core/geometry/camera";
import { button, moveOf, pressed, rumbleOf, type Felt, type Pad } from "../../../core/touch/gamepad";
import { canRumble, padName, rumble, usedPad, type ConnectedPad } from "./gamepad_device";
import type { HandControl } from "./hand_control.svelte";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";

/** Pace of the motors, and how long they run without another word [ms]. */
const rumblePace = 50;
const rumbleRest = 120;

/** What sticks and buttons move. */
interface Moved {
  readonly hand: HandControl;
  /** The tool in the hand. */
  readonly tool: { readonly press: () => void; readonly release: () => void };
  readonly view: { camera: Camera | null; readonly reset: () => void };
  /** Segments that the probe takes along. */
  readonly objects: { readonly holds: boolean; readonly grab: () => void; readonly release: () => void };
  readonly centreOnProbe: () => void;
}

export class GamepadInput {
  /** Name of the gamepad in use; null without one. */
  name = $state<string | null>(null);
  /** It has motors. */
  motors = $state(false);
  /** Its sticks move the hand; else they turn the picture. */
  touching = $state(true);
  /** Contact is felt on it. */
  rumbling = $state(recall("gamepad", { rumbling: true }).rumbling);

  private before: Pad | null = null;
  private felt: Felt | null = null;
  private rumbledAt = 0;
  private movedAt = 0;
  private running = false;
  private humming = false;

  constructor(
    private readonly session: Session,
    private readonly moved: Moved,
  ) {}

  /** Listens until the returned function is called. */
  listen(): () => void {
    const aborter = new AbortController();
    const { signal } = aborter;
    window.addEventListener("gamepadconnected", this.look.bind(this), { signal });
    window.addEventListener("gamepaddisconnected", this.look.bind(this), { signal });
    this.look();
    return () => {
      aborter.abort();
      this.leave();
    };
  }

  setRumbling(on: boolean): void {
    this.rumbling = on;
    remember("gamepad", { rumbling: on });
  }

  /** A gamepad has come or gone. */
  private look(): void {
    const pad = usedPad();
    if (pad === null) {
      this.leave();
    } else if (!this.running) {
      this.name = padName(pad);
      this.motors = canRumble(pad);
      const felt = this.motors ? ", and contact is felt on it" : "";
      this.session.notify("info", `${this.name} found: its left stick moves the hand, the triggers in depth${felt}.`);
      this.running = true;
      this.movedAt = performance.now();
      requestAnimationFrame(this.run.bind(this));
    }
  }

  private leave(): void {
    if (this.name !== null) {
      this.session.notify("info", `${this.name} is gone.`);
    }
    this.running = false;
    this.name = null;
    this.moved.tool.release();
    this.before = null;
    this.felt = null;
  }

  private run(now: number): void {
    if (!this.running) {
      return;
    }
    const pad = usedPad();
    if (pad === null) {
      this.leave();
      return;
    }
    this.steer(pad, Math.min(0.1, Math.max(0, now - this.movedAt) / 1000));
    this.movedAt = now;
    if (now - this.rumbledAt >= rumblePace) {
      this.rumbledAt = now;
      this.shake(pad);
    }
    // browsers change a pad in place: what was pressed must be kept apart
    this.before = { axes: [], buttons: pad.buttons.map(({ pressed: down, value }) => ({ pressed: down, value })) };
    requestAnimationFrame(this.run.bind(this));
  }

  private steer(pad: ConnectedPad, seconds: number): void {
    for (const index of pressed(this.before, pad)) {
      this.press(index);
    }
    this.work(pad);
    const { right, down, away, turn } = moveOf(pad, this.touching);
    if (right !== 0 || down !== 0 || away !== 0) {
      this.moved.hand.move(right * seconds, down * seconds, away * seconds);
    }
    const { camera } = this.moved.view;
    if (camera !== null && (turn[0] !== 0 || turn[1] !== 0)) {
      this.moved.view.camera = orbit(camera, turn[0] * seconds, turn[1] * seconds);
    }
  }

  /** The right shoulder presses the tool as long as it is held. */
  private work(pad: ConnectedPad): void {
    const held = (of: Pad | null): boolean => of?.buttons[button.rightShoulder]?.pressed === true;
    if (held(pad) && !held(this.before)) {
      this.moved.tool.press();
    } else if (!held(pad) && held(this.before)) {
      this.moved.tool.release();
    }
  }

  private press(index: number): void {
    if (index === button.north) {
      const { objects } = this.moved;
      if (objects.holds) {
        objects.release();
      } else {
        objects.grab();
      }
    }
    if (index === button.south) {
      this.touching = !this.touching;
    } else if (index === button.east) {
      this.moved.centreOnProbe();
    } else if (index === button.west) {
      this.moved.view.reset();
    }
  }

  private shake(pad: ConnectedPad): void {
    const state = this.session.latest;
    const open = this.session.connection.kind === "open";
    const wanted =
      state === null || !open || !this.rumbling || document.hidden
        ? { strong: 0, weak: 0 }
        : rumbleOf(this.felt, state, this.session.settings?.force_limit ?? 4);
    this.felt = state;
    const hums = wanted.strong > 0 || wanted.weak > 0;
    // silence is said once
    if (hums || this.humming) {
      rumble(pad, wanted, rumbleRest);
    }
    this.humming = hums;
  }
}
