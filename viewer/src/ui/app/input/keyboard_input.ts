/**
 * Keys of the page. Arrow and page keys move the hand while they are held, with Shift turn the view and come nearer or
 * farther, with Ctrl move the picture; the others do what the table of actions says.
 */
import { shortcutsOf, showsLatin } from "../../../core/base/shortcuts";
import type { Action } from "../actions";
import type { HandControl } from "../../features/touch/hand_control.svelte";
import type { Session } from "../../state/session.svelte";
import type { ViewControl } from "../../features/view/view_control.svelte";

/** Direction for a key: right, down, away. */
const moves: Readonly<Record<string, readonly [number, number, number]>> = {
  ArrowRight: [1, 0, 0],
  ArrowLeft: [-1, 0, 0],
  ArrowDown: [0, 1, 0],
  ArrowUp: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

/** Speed of the hand while a key is held, and with Alt [pixels per second]. */
const speed = 60;
const fineSpeed = 12;
/**
 * Of the view: turn [rad/s], move of the picture [pixels per second], change of the distance by e each so many seconds.
 */
const turnSpeed = 1;
const panSpeed = 240;
const nearSpeed = 0.8;
/** A key that is only touched counts as held this long [s]. */
const shortest = 1 / 30;

/** What concerns the page as a whole, also while a text is typed; so do undo and redo, where nothing is typed. */
const ofPage: readonly string[] = ["Ctrl+S", "Ctrl+K", "Ctrl+O", "Ctrl+,"];
const ofSteps: readonly string[] = ["Ctrl+Z", "Ctrl+Shift+Z", "Ctrl+Y"];

/** What Enter presses or ends where it has the focus. */
const pressedByEnter = "a, button, input:not([type=range]), label, summary, [role=button]";

/** What the keys lead. */
type Led = "hand" | "turn" | "picture";

export class KeyboardInput {
  private readonly byKey: ReadonlyMap<string, Action>;
  private readonly byKeyOverSlice: ReadonlyMap<string, Action>;
  private readonly held = new Set<string>();
  /** Actions that last as long as their keys are held, by their keys. */
  private readonly begun = new Map<string, Action>();
  /** Whether the keyboard has Latin letters, as far as its keys have shown. */
  private latin = true;
  /** A field in which something was typed that does not hold yet. */
  private typed: EventTarget | null = null;
  private fine = false;
  private led: Led = "hand";
  private movedAt = 0;

  constructor(
    private readonly session: Session,
    private readonly hand: HandControl,
    private readonly view: ViewControl,
    actions: readonly Action[],
    /** Whether the mouse or the keyboard is at a slice. */
    private readonly isOverSlice: () => boolean = () => false,
  ) {
    const table = (overSlice: boolean): ReadonlyMap<string, Action> =>
      new Map(
        actions
          .filter((action) => (action.overSlice ?? false) === overSlice)
          .flatMap((action) => action.keys.map((key) => [key, action] as const)),
      );
    this.byKey = table(false);
    this.byKeyOverSlice = table(true);
  }

  /** Listens until the returned function is called. */
  listen(): () => void {
    const aborter = new AbortController();
    const { signal } = aborter;
    window.addEventListener("keydown", this.press.bind(this), { signal });
    window.addEventListener("keyup", this.lift.bind(this), { signal });
    window.addEventListener("blur", this.liftAll.bind(this), { signal });
    window.addEventListener("input", ({ target }) => (this.typed = target), { signal, capture: true });
    window.addEventListener("change", () => (this.typed = null), { signal, capture: true });
    return () => {
      aborter.abort();
      this.liftAll();
    };
  }

  /** Keys that are let go elsewhere are not reported. */
  private liftAll(): void {
    this.held.clear();
    for (const key of [...this.begun.keys()]) {
      this.end(key);
    }
  }

  private lift(event: KeyboardEvent): void {
    this.held.delete(event.key);
    this.end(placeOf(event));
  }

  private end(key: string): void {
    this.begun.get(key)?.end?.();
    this.begun.delete(key);
  }

  private press(event: KeyboardEvent): void {
    // what waits for an answer waits for it alone
    if (this.belongs(event) || this.session.offer !== null) {
      return;
    }
    if (event.key in moves) {
      event.preventDefault();
      this.hold(event);
    } else if (this.act(event)) {
      event.preventDefault();
    }
  }

  /** Whether a key belongs to the control that has the focus: all to a text, some to a slider or a list. */
  private belongs(event: KeyboardEvent): boolean {
    const { target, key } = event;
    if (!(target instanceof HTMLElement)) {
      return false;
    }
    if (key === "Enter" && target.matches(pressedByEnter)) {
      return true;
    }
    if (target.matches("input[type=range], input[type=radio], [role=slider]")) {
      return key in moves;
    }
    const meant = this.shortcutsOf(event);
    if (meant.some((shortcut) => ofPage.includes(shortcut))) {
      this.settle(target);
      return false;
    }
    if (meant.some((shortcut) => ofSteps.includes(shortcut)) && target !== this.typed) {
      // what was chosen or typed there holds: it is a step of the page
      return false;
    }
    return target.matches("input:not([type=checkbox]), textarea, select");
  }

  /** What was typed in a field holds from now on. */
  private settle(field: HTMLElement): void {
    if (field === this.typed) {
      field.blur();
      field.focus();
    }
  }

  private shortcutsOf(event: KeyboardEvent): readonly string[] {
    const { code, ctrlKey, key, metaKey, shiftKey } = event;
    const altKey = event.altKey || event.getModifierState("AltGraph");
    this.latin = showsLatin(event) ?? this.latin;
    return shortcutsOf({ altKey, code, ctrlKey, key, metaKey, shiftKey }, this.latin);
  }

  /** Does what a key means, once for each press but for steps; returns whether it means something. */
  private act(event: KeyboardEvent): boolean {
    const overSlice = this.isOverSlice();
    const action = this.shortcutsOf(event).flatMap(
      (shortcut) => (overSlice ? this.byKeyOverSlice.get(shortcut) : undefined) ?? this.byKey.get(shortcut) ?? [],
    )[0];
    if (action === undefined || action.ready?.() === false) {
      return false;
    }
    if (event.repeat && action.repeats !== true) {
      return true;
    }
    if (action.end !== undefined) {
      // with Shift or without: the key that is let go ends it
      this.begun.set(placeOf(event), action);
    }
    action.run();
    return true;
  }

  private hold(event: KeyboardEvent): void {
    this.fine = event.altKey;
    this.led = event.ctrlKey || event.metaKey ? "picture" : event.shiftKey ? "turn" : "hand";
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
    const [right, down, away] = [...this.held].reduce<readonly [number, number, number]>(
      ([x, y, z], key) => {
        const [moreX, moreY, moreZ] = moves[key] ?? [0, 0, 0];
        return [x + moreX * seconds, y + moreY * seconds, z + moreZ * seconds];
      },
      [0, 0, 0],
    );
    if (this.led === "hand") {
      const pixels = this.fine ? fineSpeed : speed;
      this.hand.move(right * pixels, down * pixels, away * pixels);
    } else if (this.led === "turn") {
      this.view.turn(right * turnSpeed, down * turnSpeed);
      this.view.approach(Math.exp(-away * nearSpeed));
    } else {
      this.view.move(right * panSpeed, down * panSpeed);
      this.view.approach(Math.exp(-away * nearSpeed));
    }
  }
}

/** Which key of the keyboard it is, with Shift or without. */
function placeOf({ code, key }: KeyboardEvent): string {
  return code === "" ? key.toLowerCase() : code;
}
