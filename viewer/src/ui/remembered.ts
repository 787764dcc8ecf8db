/**
 * Small settings of the page that outlive a visit, in the browser's local storage.
 * Storage that is full or forbidden only means that nothing is remembered.
 */
const prefix = "palpate.";

export function recall<T extends object>(name: string, fallback: T): T {
  try {
    const text = localStorage.getItem(prefix + name);
    const stored: unknown = text === null ? null : JSON.parse(text);
    return typeof stored === "object" && stored !== null ? { ...fallback, ...stored } : fallback;
  } catch {
    return fallback;
  }
}

export function remember(name: string, value: object): void {
  try {
    localStorage.setItem(prefix + name, JSON.stringify(value));
  } catch {
    // nothing is remembered then
  }
}
