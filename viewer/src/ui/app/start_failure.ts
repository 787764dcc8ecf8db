/** Says why the page could not start, and what to do; made of nothing that may itself have failed. */

/** Shows every exception that nobody takes until the returned function is called: then the page stands. */
export function watchStart(host: HTMLElement): () => void {
  const aborter = new AbortController();
  const { signal } = aborter;
  window.addEventListener("error", ({ error, message }) => { showFailure(host, error ?? message); }, { signal });
  window.addEventListener("unhandledrejection", ({ reason }) => { showFailure(host, reason); }, { signal });
  return () => { aborter.abort(); };
}

/** Shows it in place of the page. */
export function showFailure(host: HTMLElement, error: unknown): void {
  if (document.querySelector("[data-testid=failure]") !== null) {
    // the first one is the cause
    return;
  }
  const page = document.createElement("div");
  page.className = "failure";
  page.setAttribute("role", "alert");
  page.dataset["testid"] = "failure";
  const reload = made("button", "Reload");
  reload.className = "framed";
  reload.addEventListener("click", () => { window.location.reload(); });
  page.append(
    made("h1", "This page could not start"),
    made("p", `The browser says: ${error instanceof Error ? error.message : String(error)}`),
    made("p", "Reload the page. If it stays so, update the browser, or open this address in a current Chrome, Edge, " +
      "Firefox or Safari. Nothing of the scan is lost: Palpate goes on without this page."),
    reload,
  );
  host.replaceChildren(page);
  // for the console; what listens here finds it shown
  reportError(error);
}

function made<K extends keyof HTMLElementTagNameMap>(tag: K, text: string): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  element.textContent = text;
  return element;
}
