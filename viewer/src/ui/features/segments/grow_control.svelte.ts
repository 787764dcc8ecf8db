/**
 * Segments that are found: by Otsu's thresholds, or grown from a point that a person presses on.
 *
 * A grown region is shown until a person keeps it. Dragging from where it was pressed, or a slider, lets more or fewer
 * values in.
 */
import type { Grown } from "../../../core/protocol";
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
/** Levels by a pixel of a drag. */
const levelsPerPixel = 0.5;

export class GrowControl {
  /** Whether the next press in the picture or in a slice grows a region. */
  armed = $state(false);
  habits = $state.raw<GrowHabits>(recall("growing", usual));
  /** How far the pointer was dragged since it went down, to the right and up [pixels]; null where it is up. */
  private dragged: number | null = null;
  /** The level that was asked for last; null is the one that was found. */
  private asked = $state<number | null>(null);

  constructor(private readonly session: Session) {
    // what was dragged while it was looked for
    session.onGrown(() => {
      this.follow();
    });
  }

  /** The region that is shown; null where none is. */
  readonly shown = $derived.by((): Grown | null => {
    const { grown, segments } = this.session;
    return grown !== null && segments.some(({ id }) => id === grown.id) ? grown : null;
  });

  /** What is done to find the region; null where it is not looked for. */
  readonly looking = $derived.by((): string | null => (this.session.growing ? this.session.segmentWork : null));

  /** The level that is shown, or will be next. */
  readonly level = $derived.by(() => this.asked ?? this.session.grown?.level ?? 0);

  change(part: Partial<GrowHabits>): void {
    this.habits = { ...this.habits, ...part };
    remember("growing", this.habits);
  }

  /** Grows a region from a point of the scene; the next press does no more. */
  from(seed: Vec3): void {
    const { spread, passage, most_ml } = this.habits;
    this.armed = false;
    this.asked = null;
    this.session.grown = null;
    this.session.growing = true;
    this.session.send({ type: "grow_segment", seed, spread, passage, most_ml });
  }

  /** Grows a region from a point where the pointer went down, which drags go on from. */
  press(seed: Vec3): void {
    this.from(seed);
    this.dragged = 0;
  }

  /** Drags by so many pixels: right and up for more, left and down for less. */
  drag(right: number, down: number): void {
    if (this.dragged !== null) {
      this.dragged += right - down;
      this.follow();
    }
  }

  /** Lets go: what is seen is kept; where nothing is seen yet, a person decides once it is. */
  release(): void {
    if (this.dragged !== null) {
      this.dragged = null;
      if (this.shown !== null) this.end(true);
    }
  }

  /** The pointer is needed for something else: what is shown stays so. */
  leave(): void {
    this.dragged = null;
  }

  /** Shows the region as far as it was dragged meanwhile. */
  follow(): void {
    const { grown } = this.session;
    if (grown !== null && this.dragged !== null) {
      this.show(grown.usual + Math.round(this.dragged * levelsPerPixel));
    }
  }

  /** Shows the region of another level. */
  show(level: number): void {
    const { grown } = this.session;
    if (grown !== null) {
      const held = Math.min(grown.most, Math.max(grown.least, level));
      if (held !== this.level) {
        this.asked = held;
        this.session.send({ type: "change_grown", level: held });
      }
    }
  }

  /** Keeps the region that is shown, or shows it no more; where it is looked for, that ends. */
  end(keeps: boolean): void {
    if (this.looking !== null) {
      this.stop();
    } else if (this.shown !== null) {
      this.session.grown = null;
      this.session.send({ type: "end_grown", keeps });
    }
    this.asked = null;
    this.dragged = null;
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
