/**
 * Text for other programs.
 */
import { plainText } from "../../core/base/format";
import type { Session } from "./session.svelte";

/**
 * Gives a text to the system's clipboard, with its numbers as programs read them, and says that it did or why it could
 * not.
 */
export async function copyText(session: Session, what: string, text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(plainText(text));
    session.notify("info", `${what} copied.`);
  } catch (error) {
    const reason = error instanceof Error ? error.message : String(error);
    session.notify("error", `The browser did not copy: ${reason}`);
  }
}
