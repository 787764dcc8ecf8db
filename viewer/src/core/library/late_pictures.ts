/**
 * Small pictures of a list that come only when they are asked for: of the volumes of long files, each of which is
 * unpacked from the file's start. One request is under way at a time, and the newest wish goes first.
 */
import type { JobLine } from "./library";

/** Asks the engine for pictures of a list; calls back with each line. */
export type AskPictures = (
  choices: readonly number[],
  signal: AbortSignal,
  told: (line: JobLine) => void,
) => Promise<void>;

/** Most that are asked for at once, so that a newer wish does not wait for long. */
const mostAtOnce = 4;

export class LatePictures {
  private wanted: number[] = [];
  /** Those that came, and those that could not be drawn. */
  private readonly asked = new Set<number>();
  private readonly leaving = new AbortController();
  private busy = false;

  constructor(
    private readonly ask: AskPictures,
    private readonly take: (line: JobLine) => void,
  ) {}

  /** Wants the picture of a choice before those that were wanted earlier. */
  want(choice: number): void {
    if (this.asked.has(choice)) {
      return;
    }
    this.wanted = [choice, ...this.wanted.filter((other) => other !== choice)];
    void this.fetch();
  }

  /** What was wanted and is out of sight is not needed any more. */
  leave(choice: number): void {
    this.wanted = this.wanted.filter((other) => other !== choice);
  }

  /** The list is gone. */
  end(): void {
    this.wanted = [];
    this.leaving.abort();
  }

  private async fetch(): Promise<void> {
    if (this.busy) {
      return;
    }
    this.busy = true;
    while (this.wanted.length > 0 && !this.leaving.signal.aborted) {
      const now = this.wanted.splice(0, mostAtOnce);
      for (const choice of now) this.asked.add(choice);
      // without its picture a volume is listed all the same
      await this.ask(now, this.leaving.signal, this.take).catch(() => undefined);
    }
    this.busy = false;
  }
}
