/** Work of the engine that tells how far it is, line by line. */
import { Lines, type JobLine } from "../core/library/library";
import { apiAddress } from "./connection";

export interface Asking {
  readonly signal: AbortSignal;
}

/** Has the engine work, and calls back with each line; leaving it cancels. Throws why it failed. */
export async function job(
  path: string,
  wanted: object,
  { signal }: Asking,
  told: (line: JobLine) => void,
): Promise<void> {
  const answer = await fetch(apiAddress(path), { method: "POST", body: JSON.stringify(wanted), signal });
  if (!answer.ok || answer.body === null) {
    throw new Error(await answer.text());
  }
  const lines = new Lines();
  const decoder = new TextDecoder();
  for (const reader = answer.body.getReader(); ; ) {
    const { done, value } = await reader.read();
    if (done) {
      return;
    }
    for (const line of lines.take(decoder.decode(value, { stream: true }))) {
      if (line.kind === "failed") {
        throw new Error(line.reason);
      }
      told(line);
    }
  }
}
