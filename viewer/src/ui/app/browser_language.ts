/** The browser's language as libraries read it: uPlot formats numbers in it, and throws where it is no valid tag. */

/** Gives the browser a language that is a tag of BCP 47, where its own is none: WebKitGTK's is "c" under LANG=C. */
export function ensureLanguage(): void {
  try {
    Intl.getCanonicalLocales(navigator.language);
  } catch {
    Object.defineProperty(navigator, "language", { get: () => "en", configurable: true });
  }
}
