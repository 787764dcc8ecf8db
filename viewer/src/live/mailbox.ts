/**
 * Messages on their way to a page that may be busy: all are kept in order, except that of
 * the states only the latest one waits, with the samples of those it replaces.
 */
import type { State, ToPage } from "../core/protocol";

/** Samples that wait at most: five seconds and a little more at 250 a second. */
const mostSamples = 1500;

export class Mailbox {
  private others: ToPage[] = [];
  private state: State | null = null;

  put(message: ToPage): void {
    if (message.type !== "state") {
      this.others.push(message);
      return;
    }
    const samples = [...(this.state?.samples ?? []), ...message.samples].slice(-mostSamples);
    this.state = { ...message, samples };
  }

  /** Hands over everything that waits. */
  take(): ToPage[] {
    const batch = this.state === null ? this.others : [...this.others, this.state];
    this.others = [];
    this.state = null;
    return batch;
  }
}
