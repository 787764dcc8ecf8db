/**
 * Segments that are found: by Otsu's thresholds, or grown from a point that a person clicks.
 */
import type { Vec3 } from "../../../core/geometry/vector";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";

/** How a region grows; see `GrowSegment` of the protocol. */
export interface GrowHabits {
  /** Null: found, from edges of values; so is the passage. */
  readonly spread: number | null;
  readonly passage: number | null;
  readonly most_ml: number;
}

const usual: GrowHabits = { spread: null, passage: null, most_ml: 2500 };

export class GrowControl {
  /** Whether the next click in the picture or in a slice grows a region. */
  armed = $state(false);
  habits = $state.raw<GrowHabits>(recall("growing", usual));

  constructor(private readonly session: Session) {}

  change(part: Partial<GrowHabits>): void {
    this.habits = { ...this.habits, ...part };
    remember("growing", this.habits);
  }

  /** Grows a region from a point of the scene; the next click does no more. */
  from(seed: Vec3): void {
    this.armed = false;
    const { spread, passage, most_ml } = this.habits;
    this.session.send({ type: "grow_segment", seed, spread, passage, most_ml });
  }

  otsu(classes: number): void {
    this.session.send({ type: "otsu", classes });
  }

  /** Grows these segments until they meet; each makes a new one. */
  fromSeeds(ids: readonly number[], smoothing: number): void {
    this.session.send({ type: "grow_seeds", ids: [...ids], smoothing });
  }

  stop(): void {
    this.session.send({ type: "stop_segment_work" });
  }
}
