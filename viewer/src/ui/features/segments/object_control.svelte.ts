/**
 * Objects in a person's hand: which one has handles in the picture, where it is dragged to, and
 * which one the probe holds.
 */
import { turned, unmoved } from "../../../core/geometry/object_pose";
import type { Pose, Segment } from "../../../core/protocol";
import { scale, type Vec3 } from "../../../core/geometry/vector";
import type { Session } from "../../state/session.svelte";

export class ObjectControl {
  /** The segment with handles in the picture. */
  handled = $state.raw<number | null>(null);
  /** Where a segment is dragged to, before the engine tells it. */
  dragged = $state.raw<{ readonly id: number; readonly pose: Pose } | null>(null);
  /** Whether a segment in the hand of the probe stops at others. */
  collides = $state(false);

  /** The segments whose gap is watched. */
  watched = $state.raw<readonly [number, number] | null>(null);

  private sending = false;
  private grabbing = false;

  constructor(private readonly session: Session) {}

  /** Where a segment was asked to stand. */
  asked({ id, pose }: Segment): Pose {
    return this.dragged?.id === id ? this.dragged.pose : (pose ?? unmoved);
  }

  /** Has the gap of a pair measured while it moves, or none. */
  watch(pair: readonly [number, number] | null): void {
    this.watched = pair;
    this.session.gap = null;
    this.session.send({ type: "watch_gap", pair });
  }

  /** Asks for a pose, at most once a frame. */
  drag(id: number, pose: Pose): void {
    this.dragged = { id, pose };
    if (!this.sending) {
      this.sending = true;
      requestAnimationFrame(() => {
        this.sending = false;
        this.sendDragged(true);
      });
    }
  }

  /** The handle is let go: what was dragged since it was taken is one step of undo. */
  drop(): void {
    this.sendDragged(false);
    this.dragged = null;
  }

  /** Asks for a pose once. */
  move(id: number, pose: Pose): void {
    this.session.send({ type: "move_segment", id, pose, goes_on: false });
  }

  /** Has the touched segment, or another, follow the probe. */
  grab(id: number | null = null): void {
    const touched = this.session.latest?.touched ?? 0;
    const wanted = id ?? (touched > 0 ? touched : null);
    if (wanted === null) {
      this.session.notify("info", "Touch the segment that you want to grab.");
      return;
    }
    this.grabbing = true;
    this.session.send({ type: "grab", id: wanted, collides: this.collides });
  }

  /** Lets go of what the probe holds. */
  release(): void {
    if (this.grabbing || (this.session.latest?.grabbed ?? 0) > 0) {
      this.grabbing = false;
      this.session.send({ type: "grab", id: null, collides: this.collides });
    }
  }

  /** Whether the probe holds something. */
  get holds(): boolean {
    return (this.session.latest?.grabbed ?? 0) > 0;
  }

  /** Turns what the probe holds about an axis [rad]. */
  turn(axis: Vec3, angle: number): void {
    this.session.send({ type: "turn_grabbed", rotation: scale(axis, angle) });
  }

  /** Turns a segment that the probe does not hold about a point. */
  turnAbout(segment: Segment, centre: Vec3, axis: Vec3, angle: number): void {
    this.move(segment.id, turned(this.asked(segment), centre, axis, angle));
  }

  private sendDragged(goesOn: boolean): void {
    if (this.dragged !== null) {
      this.session.send({ type: "move_segment", ...this.dragged, goes_on: goesOn });
    }
  }
}
