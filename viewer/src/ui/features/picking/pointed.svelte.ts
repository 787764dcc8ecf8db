/**
 * What the mouse stands on in the 3-D view, looked up as soon as it rests: the picture never waits for it.
 */
import type { Reading } from "./readout.svelte";

/** So long the mouse rests before it is looked up [ms]. */
const rest = 80;

export class Pointed {
  shown = $state.raw<Reading | null>(null);
  private waiting: ReturnType<typeof setTimeout> | undefined;

  /** The mouse has moved; `look` says what it stands on, null where that is nothing. */
  move(look: () => Reading | null): void {
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => {
      this.shown = look();
    }, rest);
  }

  leave(): void {
    clearTimeout(this.waiting);
    this.shown = null;
  }
}
