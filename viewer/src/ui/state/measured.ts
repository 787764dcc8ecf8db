/** What the engine measures for the page, once nothing changes any more. */
import { apiAddress } from "../../live/connection";

/** What is asked for, and what becomes of the answer. */
interface Measurement {
  readonly path: string;
  readonly wanted?: object;
  /** So long nothing changes before it is asked for [ms]. */
  readonly rest: number;
  readonly take: (answer: string) => void;
  /** Told why there is no answer. */
  readonly fail: (reason: string) => void;
}

/** Asks after a rest; returns what cancels it, as effects do. */
export function measureAtRest({ path, wanted, rest, take, fail }: Measurement): () => void {
  const cancelled = new AbortController();
  const { signal } = cancelled;
  const ask = async (): Promise<void> => {
    try {
      const body = wanted === undefined ? null : JSON.stringify(wanted);
      const answer = await fetch(apiAddress(path), { method: "POST", body, signal });
      const said = await answer.text();
      if (!answer.ok) {
        throw new Error(said);
      }
      take(said);
    } catch (error) {
      if (!signal.aborted) {
        fail(error instanceof Error ? error.message : String(error));
      }
    }
  };
  const begun = setTimeout(() => void ask(), rest);
  return () => {
    clearTimeout(begun);
    cancelled.abort();
  };
}
