/**
 * Steps of undo that the engine makes, as the page sees them in its states: how many there are, so that the page's own
 * find their place among them. What others take back or make again is known only in part; then a step of the page
 * may come before one of the engine that is newer, but none is lost.
 */
import type { State } from "../core/protocol";
import type { Session } from "./session.svelte";

export class EngineSteps {
  /** How many were made since the page was opened, less those that were taken back. */
  count = $state.raw(0);

  /** What the engine's history holds and whether something can be made again: another step changes one of them. */
  private seen: { readonly bytes: number; readonly canRedo: boolean } | null = null;
  /** Undo and redo that were asked for and are not answered yet: what changes meanwhile is theirs. */
  private asked = 0;
  private greetings = 0;

  /** @param made is called when the engine has made a step. */
  constructor(
    private readonly session: Session,
    private readonly made: () => void,
  ) {
    session.onState((state) => {
      this.follow(state);
    });
  }

  get canUndo(): boolean {
    return this.latest?.can_undo === true;
  }

  get canRedo(): boolean {
    return this.latest?.can_redo === true;
  }

  undo(): void {
    this.ask("undo", this.canUndo ? -1 : 0);
  }

  redo(): void {
    this.ask("redo", this.canRedo ? 1 : 0);
  }

  /** The newest state; what shows it is told at the pace that can be read. */
  private get latest(): State | null {
    return this.session.live && this.session.latest;
  }

  private ask(type: "undo" | "redo", change: number): void {
    this.count += change;
    this.asked += 1;
    this.session.send({ type });
    this.session.whenTold(() => {
      this.asked -= 1;
    });
  }

  private follow({ tool, can_redo: canRedo }: State): void {
    const { seen } = this;
    const { greetings } = this.session;
    const isAnother = greetings !== this.greetings;
    this.seen = { bytes: tool.undo_bytes, canRedo };
    this.greetings = greetings;
    if (seen === null || isAnother || this.asked > 0 || (seen.bytes === tool.undo_bytes && seen.canRedo === canRedo)) {
      return;
    }
    if (!canRedo) {
      this.count += 1;
      this.made();
    } else if (!seen.canRedo) {
      // another page has taken it back
      this.count -= 1;
    }
  }
}
