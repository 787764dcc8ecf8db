/**
 * What a page leaves to the one that takes its place in the same tab, in the browser's session storage.
 * Storage that is full or forbidden only means that nothing is left.
 */
const name = "palpate.passed";

export interface Handover {
  /** Its identity: nothing of the patient. */
  readonly scan: string;
  readonly view: Readonly<Record<string, unknown>>;
}

export function handOver(passed: Handover): void {
  try {
    sessionStorage.setItem(name, JSON.stringify(passed));
  } catch {
    // nothing is left then
  }
}

/** Takes what was left, once. */
export function takeHandover(): Handover | null {
  try {
    const text = sessionStorage.getItem(name);
    sessionStorage.removeItem(name);
    const passed = text === null ? null : (JSON.parse(text) as Partial<Handover> | null);
    return typeof passed?.scan === "string" && typeof passed.view === "object" ? (passed as Handover) : null;
  } catch {
    return null;
  }
}
