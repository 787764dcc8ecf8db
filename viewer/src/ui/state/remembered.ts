/**
 * Small settings of the page that outlive a visit, in the browser's local storage: a person's own, and nothing of a
 * patient (`scan_memory.ts`).
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

/** What earlier versions have left of scans, under the names of these: it may be of any patient. */
const parts = "marks|landmarks|clip|window|appearance|optics|curve|lighting|inside|unfelt|brush|matter|second|table";
const ofScans = new RegExp(`^palpate\\.((${parts})\\.|needle$)`);

/** Removes all that the browser's storage has of scans. */
export function forgetScans(): void {
  try {
    for (const key of Object.keys(localStorage).filter((each) => ofScans.test(each))) {
      localStorage.removeItem(key);
    }
  } catch {
    // nothing is remembered then
  }
}

/** How the picture is divided: a scene brings it along. */
const layout = "slices";

/** Parts of it that are a person's own, whoever has saved a scene. */
const own = ["slab", "slabMode"];

/** What of a person's preferences goes into a scene. */
export function keptLayout(): Readonly<Record<string, unknown>> {
  return { [layout]: recall(layout, {}) };
}

/** Takes up what `keptLayout` has returned, also elsewhere. */
export function bringLayout(kept: unknown): void {
  const value: unknown = typeof kept === "object" && kept !== null ? (kept as Record<string, unknown>)[layout] : null;
  if (typeof value === "object" && value !== null) {
    const shared = Object.entries(value).filter(([part]) => !own.includes(part));
    remember(layout, { ...recall(layout, {}), ...Object.fromEntries(shared) });
  }
}
