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

/** Beside what is remembered of a scan: how the picture is divided. */
const layout = "slices";

/** Parts of it that are a person's own, whoever has saved a scene. */
const own = ["slab", "slabMode"];

/** All that is remembered of a scan's appearance, by name without the scan's. */
export function keptOf(scanName: string): Record<string, unknown> {
  const kept: Record<string, unknown> = { [layout]: recall(layout, {}) };
  try {
    const ending = `.${scanName}`;
    for (const key of Object.keys(localStorage)) {
      if (key.startsWith(prefix) && key.endsWith(ending)) {
        kept[key.slice(prefix.length, -ending.length)] = JSON.parse(localStorage.getItem(key) ?? "null");
      }
    }
  } catch {
    // what cannot be read is not kept
  }
  return kept;
}

/** Remembers what `keptOf` has returned for a scan, also elsewhere and under another name. */
export function bring(scanName: string, kept: unknown): void {
  if (typeof kept !== "object" || kept === null) {
    return;
  }
  for (const [name, value] of Object.entries(kept)) {
    if (typeof value === "object" && value !== null && /^[a-z]{1,32}$/i.test(name)) {
      if (name === layout) {
        const kept = Object.entries(value).filter(([part]) => !own.includes(part));
        remember(layout, { ...recall(layout, {}), ...Object.fromEntries(kept) });
      } else {
        remember(`${name}.${scanName}`, value as object);
      }
    }
  }
}
