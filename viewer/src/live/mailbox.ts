/**
 * Messages on their way to a page that may be busy: of the states only the latest one waits, with
 * the samples of those it replaces; all others are handed over at once and in order.
 */
import type { State, ToPage } from "../core/protocol";

/** Samples that wait at most: five seconds and a little more at 250 a second. */
const mostSamples = 1500;

/** A message, and when it arrived [ms since 1970]. */
export interface Letter {
  readonly message: ToPage;
  readonly arrived: number;
}

export class Mailbox {
  private others: Letter[] = [];
  private state: (Letter & { readonly message: State }) | null = null;

  put(message: ToPage, arrived = 0): void {
    if (message.type !== "state") {
      this.others.push({ message, arrived });
      return;
    }
    const samples = [...(this.state?.message.samples ?? []), ...message.samples].slice(-mostSamples);
    this.state = { message: { ...message, samples }, arrived };
  }

  /** Hands over what waits; the state only to a page that is ready for it. */
  take(ready: boolean): Letter[] {
    const state = ready ? this.state : null;
    const batch = state === null ? this.others : [...this.others, state];
    this.others = [];
    this.state = ready ? null : this.state;
    return batch;
  }

  /** Drops the state that waits: it came from an engine that is gone. */
  drop(): void {
    this.state = null;
  }
}

/** The memory that letters with many bytes hold: it can be handed over instead of copied. */
export function memoryOf(letters: readonly Letter[]): ArrayBuffer[] {
  const views = letters.flatMap(({ message }) =>
    message.type === "drawn_picture"
      ? [message.colours, message.depths]
      : message.type === "changed"
      ? [
          ...(message.displaced ?? []).map(({ moved }) => moved),
          ...message.voxels.flatMap(({ stored, labels }) => [stored, labels]),
          ...message.surfaces.flatMap(({ patches }) =>
            patches.flatMap(({ vertices, normals, triangles }) => [vertices, normals, triangles]),
          ),
        ]
      : [],
  );
  // all bytes of one message lie in the memory that it arrived in
  return [...new Set(views.flatMap((view) => (view === null ? [] : [view.buffer as ArrayBuffer])))];
}
