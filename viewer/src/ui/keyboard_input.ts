/**
 * Keys of the page. Arrow and page keys move the hand while they are held; letters act once.
 */
import type { Letter } from "../core/anatomy";
import { toolChoices } from "../core/tools";
import { larger, stiffer } from "../core/touch_settings";
import type { HandControl } from "./hand_control.svelte";
import type { Session } from "./session.svelte";
import type { Stage } from "./stage.svelte";
import type { ToolHand } from "./tool_hand.svelte";

/** Direction of the hand for a key: right, down, away. */
const moves: Readonly<Record<string, readonly [number, number, number]>> = {
  ArrowRight: [1, 0, 0],
  ArrowLeft: [-1, 0, 0],
  ArrowDown: [0, 1, 0],
  ArrowUp: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

const views: Readonly<Record<string, Letter>> = { "1": "A", "2": "P", "3": "L", "4": "R", "5": "S", "6": "I" };

/** Held, it presses the tool. */
const pressKey = "x";

/** Held, the hand moves without the probe. */
const clutchKey = "k";

/** Speed of the hand while a key is held, and with Alt [pixels per second]. */
const speed = 60;
const fineSpeed = 12;
/** Turn of what the probe holds by one press [rad]. */
const turnStep = (2 * Math.PI) / 180;
/** A key that is only touched moves the hand as if held this long [s]. */
const shortest = 1 / 30;

/** What keys do that concerns the page as a whole. */
export interface KeyActions {
  readonly save: () => void;
  readonly help: () => void;
  readonly sound: () => void;
  readonly guarantees: () => void;
  readonly escape: () => void;
}

export class KeyboardInput {
  private readonly held = new Set<string>();
  private fine = false;
  private movedAt = 0;

  constructor(
    private readonly session: Session,
    private readonly stage: Stage,
    private readonly hand: HandControl,
    private readonly tool: ToolHand,
    private readonly actions: KeyActions,
  ) {}

  /** Listens until the returned function is called. */
  listen(): () => void {
    const aborter = new AbortController();
    const { signal } = aborter;
    window.addEventListener("keydown", this.press.bind(this), { signal });
    window.addEventListener("keyup", this.lift.bind(this), { signal });
    window.addEventListener("blur", this.liftAll.bind(this), { signal });
    return () => {
      aborter.abort();
      this.liftAll();
    };
  }

  /** Keys that are let go elsewhere are not told of. */
  private liftAll(): void {
    this.held.clear();
    this.hand.clutch(false);
    this.tool.release();
  }

  private lift(event: KeyboardEvent): void {
    this.held.delete(event.key);
    const key = event.key.toLowerCase();
    if (key === "g") {
      this.stage.objects.release();
    } else if (key === clutchKey) {
      this.hand.clutch(false);
    } else if (key === pressKey) {
      this.tool.release();
    }
  }

  private press(event: KeyboardEvent): void {
    // what waits for an answer waits for it alone
    if (belongsTo(event.target, event.key) || this.session.offer !== null) {
      return;
    }
    if (event.key in moves) {
      event.preventDefault();
      this.hold(event);
    } else if (this.act(event)) {
      event.preventDefault();
    }
  }

  /** Returns whether the key means something. */
  private act(event: KeyboardEvent): boolean {
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey) {
      return this.actWithControl(key, event.shiftKey);
    }
    const view = views[key];
    if (view !== undefined) {
      this.stage.lookFrom(view);
      return true;
    }
    return this.actOnTool(key) || this.actOnTouch(key) || this.actOnPage(key, event.shiftKey);
  }

  private actOnTool(key: string): boolean {
    if (key === pressKey) {
      return this.tool.press();
    }
    const choice = toolChoices.find((other) => other.key === key);
    if (choice !== undefined) {
      this.tool.choose(choice.kind);
    }
    return choice !== undefined;
  }

  /** Settings of touch, for a hand that does not want to leave the picture. */
  private actOnTouch(key: string): boolean {
    const { settings, deviceLimits } = this.session;
    if (settings === null) {
      return false;
    }
    const { stiffness, probe_radius, smoothing } = settings;
    switch (key) {
      case "[":
        this.session.changeSettings({ stiffness: stiffer(stiffness, -1, deviceLimits) });
        return true;
      case "]":
        this.session.changeSettings({ stiffness: stiffer(stiffness, 1, deviceLimits) });
        return true;
      case "-":
        this.session.changeSettings({ probe_radius: larger(probe_radius, -1) });
        return true;
      case "+":
      case "=":
        this.session.changeSettings({ probe_radius: larger(probe_radius, 1) });
        return true;
      case "v":
        this.session.changeSettings({ smoothing: smoothing === "off" ? "intensities" : "off" });
        return true;
      default:
        return false;
    }
  }

  private actOnPage(key: string, shift: boolean): boolean {
    switch (key) {
      case "c":
        this.stage.centreOnProbe();
        return true;
      case "f":
        this.stage.frameAll();
        return true;
      case "g":
        if (shift) {
          this.actions.guarantees();
        } else if (!this.stage.objects.holds) {
          this.stage.objects.grab();
        }
        return true;
      case ",":
      case ".":
        return this.turnHeld(key === "," ? 1 : -1);
      case "l":
        this.stage.slices.nextLayout();
        return true;
      case "n":
        this.stage.mark({ normal: !this.stage.shown.normal });
        return true;
      case "o":
        this.stage.orthographic = !this.stage.orthographic;
        return true;
      case "p":
        this.stage.mark({ path: !this.stage.shown.path });
        return true;
      case "r":
        if (shift) {
          this.session.toggleRecording();
        } else {
          this.stage.resetView();
        }
        return true;
      case "s":
        this.actions.sound();
        return true;
      case clutchKey:
        this.hand.clutch(true);
        return true;
      case "t":
        this.hand.touchMode = !this.hand.touchMode;
        return true;
      case "?":
        this.actions.help();
        return true;
      case "enter":
        this.stage.cutting.cut();
        return this.stage.cutting.ready;
      case "escape":
        this.stage.cutting.cancel();
        this.hand.touchMode = false;
        this.actions.escape();
        return true;
      default:
        return false;
    }
  }

  /** Turns what the probe holds in the picture; false where it holds nothing. */
  private turnHeld(direction: number): boolean {
    const { camera, objects } = this.stage;
    if (camera === null || !objects.holds) {
      return false;
    }
    objects.turn(camera.back, direction * turnStep);
    return true;
  }

  private actWithControl(key: string, shift: boolean): boolean {
    if (key === "z") {
      this.session.send({ type: shift ? "redo" : "undo" });
      return true;
    }
    if (key === "y") {
      this.session.send({ type: "redo" });
      return true;
    }
    if (key === "s") {
      this.actions.save();
      return true;
    }
    return false;
  }

  private hold(event: KeyboardEvent): void {
    this.fine = event.altKey;
    if (event.repeat || this.held.has(event.key)) {
      return;
    }
    const running = this.held.size > 0;
    this.held.add(event.key);
    this.step(shortest);
    if (!running) {
      this.movedAt = performance.now();
      requestAnimationFrame(this.run.bind(this));
    }
  }

  private run(now: number): void {
    if (this.held.size === 0) {
      return;
    }
    this.step(Math.min(0.1, Math.max(0, now - this.movedAt) / 1000));
    this.movedAt = now;
    requestAnimationFrame(this.run.bind(this));
  }

  private step(seconds: number): void {
    const pixels = (this.fine ? fineSpeed : speed) * seconds;
    let [right, down, away] = [0, 0, 0];
    for (const key of this.held) {
      const [x, y, z] = moves[key] ?? [0, 0, 0];
      right += x;
      down += y;
      away += z;
    }
    this.hand.move(right * pixels, down * pixels, away * pixels);
  }
}

/** Whether a key belongs to the control that has the focus: all to a text, some to a slider. */
function belongsTo(target: EventTarget | null, key: string): boolean {
  if (!(target instanceof HTMLElement)) {
    return false;
  }
  if (target.matches("input[type=range], input[type=radio], [role=slider]")) {
    return key in moves;
  }
  return target.matches("input:not([type=checkbox]), textarea, select");
}
