/** Files that are kept by the browser: of the engine on request, or made by the page. */
import { apiAddress } from "../../live/connection";

/** Asks for a file and has the browser keep it; returns the answer's headers. Throws the reason. */
export async function fetchFile(path: string, token: string, wanted: object, name: string): Promise<Headers> {
  const answer = await fetch(apiAddress(path, token), { method: "POST", body: JSON.stringify(wanted) });
  if (!answer.ok) {
    throw new Error(await answer.text());
  }
  const told = /filename="([^"]+)"/.exec(answer.headers.get("content-disposition") ?? "")?.[1];
  keep(await answer.blob(), told ?? name);
  return answer.headers;
}

/** Has the browser keep a file. */
export function keep(content: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  // the browser has taken it up by then
  setTimeout(() => {
    URL.revokeObjectURL(link.href);
  }, 60_000);
}
