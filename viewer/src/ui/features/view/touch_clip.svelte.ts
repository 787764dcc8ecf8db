/**
 * Has touch cut where the picture is, as long as a person wants that: what is seen is what is felt. The engine is told
 * of the latest planes once it has followed those before.
 */
import type { Plane } from "../../../core/view/clip";
import type { ClipPlanes } from "../../../core/protocol";
import type { Session } from "../../state/session.svelte";
import { recall, remember } from "../../state/remembered";
import type { ClipControl } from "./clip_control.svelte";

const memory = "clip-touch";
const nothing: readonly Plane[] = [];

export class TouchClip {
  /** Whether what is cut away from the picture is cut away from touch. */
  on = $state(recall(memory, { on: true }).on);
  /** Whether touch is cut otherwise than from here: another page has asked for that. */
  byOthers = $state(false);

  /** What was asked for last, and what the engine had said before it. */
  private asked: readonly Plane[] = nothing;
  private before: ClipPlanes | null = null;
  private greetings = 0;

  constructor(
    private readonly session: Session,
    private readonly clips: ClipControl,
  ) {
    session.onState(() => {
      this.follow();
    });
  }

  /** The planes that touch is to be cut at. */
  private readonly wanted = $derived.by((): readonly Plane[] => (this.on ? this.clips.cutting : nothing));

  switch(on: boolean): void {
    this.on = on;
    remember(memory, { on });
  }

  private follow(): void {
    const { session, wanted } = this;
    if (session.greetings !== this.greetings) {
      // an engine that has just greeted was told of nothing yet
      this.greetings = session.greetings;
      this.asked = nothing;
      this.before = null;
    }
    if (this.before === session.touchClip) {
      return;
    }
    const isOther = !isSame(wanted, told(this.asked));
    this.asked = wanted;
    this.byOthers = !isOther && !isSame(wanted, session.touchClip);
    if (isOther) {
      this.before = session.touchClip;
      session.send({ type: "change_touch_clip", planes: told(wanted) });
    }
  }
}

function told(planes: readonly Plane[]): ClipPlanes {
  return planes.map(({ normal, offset }) => [normal, offset]);
}

function isSame(planes: readonly Plane[], others: ClipPlanes): boolean {
  return JSON.stringify(told(planes)) === JSON.stringify(others);
}
