/**
 * Islands of a segment: which of them would go is shown in the picture, and then a person decides.
 */
import type { Islands, Segment } from "../../../core/protocol";
import type { Session } from "../../state/session.svelte";

/** Which islands stay. */
export interface IslandRule {
  /** At most so many, the largest ones. */
  readonly most: number;
  /** None that is smaller [ml]. */
  readonly leastMl: number;
}

/** As many as there can be. */
export const anyNumber = 1_000_000;

export class IslandsControl {
  constructor(private readonly session: Session) {}

  /** What is shown, as long as its segments are there; null where nothing is. */
  readonly shown = $derived.by((): Islands | null => {
    const { islands } = this.session;
    const isThere = (wanted: number): boolean => this.session.segments.some(({ id }) => id === wanted);
    return islands !== null && isThere(islands.id) && (islands.preview === null || isThere(islands.preview))
      ? islands
      : null;
  });

  /** The segment whose islands are shown. */
  readonly segment = $derived.by((): Segment | null =>
    this.session.segments.find(({ id }) => id === this.shown?.id) ?? null,
  );

  /** Whether a person has asked which islands of a segment would go, and has not decided yet. */
  areAskedFor(id: number): boolean {
    return this.session.islands?.id === id;
  }

  /** Shows which islands would go. */
  show(id: number, { most, leastMl }: IslandRule): void {
    this.session.send({ type: "show_islands", id, most, least_ml: leastMl });
  }

  /** Removes what is shown, or keeps it. */
  end(removes: boolean): void {
    if (this.session.islands !== null) {
      this.session.islands = null;
      this.session.send({ type: "end_going", removes });
    }
  }
}
