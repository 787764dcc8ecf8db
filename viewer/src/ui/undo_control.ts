/**
 * Undo and redo of the whole page: edits, which the engine takes back, and marks and clipping, which only the
 * page knows. What was changed last is taken back first.
 */
import type { PageSteps } from "./page_steps.svelte";
import type { Session } from "./session.svelte";

export class UndoControl {
  constructor(
    private readonly session: Session,
    private readonly steps: PageSteps,
  ) {}

  get canUndo(): boolean {
    return this.steps.canUndo || this.session.live?.can_undo === true;
  }

  get canRedo(): boolean {
    return this.steps.canRedo || this.session.live?.can_redo === true;
  }

  undo(): void {
    const { steps, session } = this;
    if (steps.canUndo && (steps.changedLast || session.latest?.can_undo !== true)) {
      steps.undo();
    } else {
      session.send({ type: "undo" });
    }
  }

  redo(): void {
    const { steps, session } = this;
    if (steps.canRedo && (steps.changedLast || session.latest?.can_redo !== true)) {
      steps.redo();
    } else {
      session.send({ type: "redo" });
    }
  }
}
