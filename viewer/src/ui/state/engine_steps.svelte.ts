/**
 * Steps of undo that the engine makes, as its states tell of them: how many there are, so that the page's own find
 * their place among them.
 */
import type { State } from "../../core/protocol";
import type { PageSteps } from "./page_steps.svelte";
import type { Session } from "./session.svelte";

export class EngineSteps {
  /** How many were made, less those that were taken back. */
  count = $state.raw(0);

  /** How many were made when the engine last reported, and in which greeting that was. */
  private made = 0;
  private greetings = 0;

  /** @param steps those of the page, which follow what the engine tells. */
  constructor(
    private readonly session: Session,
    private readonly steps: Pick<PageSteps, "forgetUndone" | "fallBack">,
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
    this.session.send({ type: "undo" });
  }

  redo(): void {
    this.session.send({ type: "redo" });
  }

  /** The newest state; what shows it changes at the pace that can be read. */
  private get latest(): State | null {
    return this.session.live && this.session.latest;
  }

  private follow({ step, steps_made: made }: State): void {
    const { greetings } = this.session;
    // another engine has counted from another beginning
    if (made > this.made && greetings === this.greetings) {
      this.steps.forgetUndone();
    }
    if (step < this.count) {
      this.steps.fallBack(step);
    }
    this.count = step;
    this.made = made;
    this.greetings = greetings;
  }
}
