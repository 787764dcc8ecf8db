/** Files that are kept by the browser: of the engine on request, or made by the page. */
import { apiAddress } from "../../live/connection";
import type { Session } from "./session.svelte";

/** A file that the browser keeps: its name, and what the engine notes of it, a line each. */
export interface KeptFile {
  readonly name: string;
  readonly notes: readonly string[];
}

/** Status of an answer: what was asked for is done once a person has confirmed something. */
const toConfirm = 428;

/** The engine did not make a file; the message says why. */
export class RefusedError extends Error {
  constructor(
    reason: string,
    /** Whether it makes the file once a person has confirmed what the reason names. */
    readonly canBeConfirmed: boolean,
  ) {
    super(reason);
  }
}

/** Asks for a file and has the browser keep it. Throws `RefusedError`. */
export async function fetchFile(path: string, wanted: object, otherwise: string): Promise<KeptFile> {
  const answer = await fetch(apiAddress(path), { method: "POST", body: JSON.stringify(wanted) });
  if (!answer.ok) {
    throw new RefusedError(await answer.text(), answer.status === toConfirm);
  }
  const told = /filename="([^"]+)"/.exec(answer.headers.get("content-disposition") ?? "")?.[1];
  const name = told ?? otherwise;
  keep(await answer.blob(), name);
  const notes = decodeURIComponent(answer.headers.get("x-palpate-notes") ?? "");
  return { name, notes: notes.split("\n").filter((line) => line !== "") };
}

/** Tells a person of a file that the browser keeps. */
export function tellSaved(session: Pick<Session, "notify">, name: string): void {
  session.notify("info", `Saved as ${name}, with the downloads of this browser.`);
}

/** Has the browser keep a file that the page made, and says so. */
export function saveFile(session: Pick<Session, "notify">, content: Blob, name: string): void {
  keep(content, name);
  tellSaved(session, name);
}

function keep(content: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  // the browser has taken it up by then
  setTimeout(() => {
    URL.revokeObjectURL(link.href);
  }, 60_000);
}
