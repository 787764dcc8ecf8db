/**
 * How often the picture follows edits: as a person chose, or by the time that the page needs.
 */
import { EditRate, editRates, type EditRateChoice, type Every } from "../../../core/view/edit_rate";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";

export class EditRateControl {
  choice = $state.raw<EditRateChoice>("auto");
  /** Every how many frames of the picture it follows now. */
  every = $state.raw<Every>(1);

  private readonly pace = new EditRate();
  private lastEdit = 0;
  private editedAt: number | null = null;
  /** The engine that the pace was sent to. */
  private told = { every: 1, greeting: 0 };

  constructor(private readonly session: Session) {
    const { choice } = recall<{ choice: EditRateChoice }>("editPace", { choice: "auto" });
    this.choice = editRates.includes(choice) ? choice : "auto";
  }

  choose(choice: EditRateChoice): void {
    this.choice = choice;
    remember("editPace", { choice });
  }

  /** A frame begins at `now` [ms] that shows edits up to number `edit`. */
  begin(now: number, edit: number): void {
    if (this.editedAt !== null) {
      this.pace.learn(now - this.editedAt);
    }
    this.editedAt = edit === this.lastEdit ? null : now;
    this.lastEdit = edit;
    this.tell();
  }

  private tell(): void {
    const every = this.choice === "auto" ? this.pace.every : this.choice;
    if (every !== this.every) {
      this.every = every;
    }
    const { greetings } = this.session;
    // an engine follows every edit until it is asked otherwise
    const before = this.told.greeting === greetings ? this.told.every : 1;
    if (every !== before) {
      this.session.send({ type: "follow_edits", every });
    }
    this.told = { every, greeting: greetings };
  }
}
