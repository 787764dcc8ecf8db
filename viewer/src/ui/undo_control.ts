/**
 * Undo and redo of the whole page: edits, which the engine takes back, and marks, which only the page
 * knows. What was changed last is taken back first.
 */
import type { MarkControl } from "./mark_control.svelte";
import type { Session } from "./session.svelte";

export class UndoControl {
  constructor(
    private readonly session: Session,
    private readonly marks: MarkControl,
  ) {}

  get canUndo(): boolean {
    return this.marks.canUndo || this.session.live?.can_undo === true;
  }

  get canRedo(): boolean {
    return this.marks.canRedo || this.session.live?.can_redo === true;
  }

  undo(): void {
    const { marks, session } = this;
    if (marks.canUndo && (marks.changedLast || session.latest?.can_undo !== true)) {
      marks.undo();
    } else {
      session.send({ type: "undo" });
    }
  }

  redo(): void {
    const { marks, session } = this;
    if (marks.canRedo && (marks.changedLast || session.latest?.can_redo !== true)) {
      marks.redo();
    } else {
      session.send({ type: "redo" });
    }
  }
}
