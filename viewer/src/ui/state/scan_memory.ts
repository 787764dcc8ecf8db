/**
 * What is kept with the scan that is open: marks, clipping, windows, looks. The engine keeps it, and every page of the
 * session has the same; nothing of it stays in the browser. Each part has a name of its own, so that what is changed on
 * two pages at once stands side by side.
 */
import { deepEqual } from "../../core/base/deep_equal";
import type { FromPage, Kept, KeptPart } from "../../core/protocol";

/** Is told that a part is another one by now, changed elsewhere; null where it was removed. */
type Listener = (name: string, value: object | null) => void;

interface Part {
  readonly version: number;
  readonly value: object | null;
  /** Changes that were sent and are not answered. */
  readonly unanswered: number;
}

const none: Part = { version: 0, value: null, unanswered: 0 };

export class ScanMemory {
  private parts: ReadonlyMap<string, Part> = new Map();
  private listeners: readonly Listener[] = [];

  constructor(private readonly send: (message: FromPage) => void) {}

  /** Calls back with every part that is changed elsewhere. */
  onChange(listener: Listener): void {
    this.listeners = [...this.listeners, listener];
  }

  /** Takes all that an engine has as it greets this page. */
  greet(kept: readonly KeptPart[]): void {
    const before = this.parts;
    this.parts = new Map(kept.map((part) => [part.name, partOf(part)]));
    for (const name of new Set([...before.keys(), ...this.parts.keys()])) {
      this.tell(name, before.get(name)?.value ?? null);
    }
  }

  /** Takes what the engine reports of a part. What this page has changed since holds until that is answered too. */
  take({ part, answers }: Kept): void {
    const before = this.parts.get(part.name) ?? none;
    const unanswered = Math.max(0, before.unanswered - (answers ? 1 : 0));
    const reported = partOf(part);
    const value = unanswered > 0 ? before.value : reported.value;
    this.set(part.name, { version: reported.version, value, unanswered });
    this.tell(part.name, before.value);
  }

  /** A part, with what it lacks as in `fallback`. */
  recall<T extends object>(name: string, fallback: T): T {
    const value = this.parts.get(name)?.value ?? null;
    return value === null ? fallback : { ...fallback, ...value };
  }

  /** All parts, by their names. */
  get everything(): Readonly<Record<string, object>> {
    return Object.fromEntries([...this.parts].flatMap(([name, { value }]) => (value === null ? [] : [[name, value]])));
  }

  /** All parts of a kind, such as "mark.1f" of marks, each with the rest of its name. */
  all(kind: string): readonly (readonly [string, object])[] {
    return [...this.parts].flatMap(([name, { value }]) =>
      name.startsWith(`${kind}.`) && value !== null ? [[name.slice(kind.length + 1), value] as const] : [],
    );
  }

  /** Keeps a part, or removes it. */
  keep(name: string, value: object | null): void {
    const before = this.parts.get(name) ?? none;
    if (!deepEqual(before.value, value)) {
      this.set(name, { ...before, value, unanswered: before.unanswered + 1 });
      this.send({ type: "keep", name, value: value === null ? null : JSON.stringify(value), after: before.version });
    }
  }

  private set(name: string, part: Part): void {
    this.parts = new Map([...this.parts, [name, part]]);
  }

  private tell(name: string, before: object | null): void {
    const value = this.parts.get(name)?.value ?? null;
    if (!deepEqual(before, value)) {
      for (const listener of this.listeners) {
        listener(name, value);
      }
    }
  }
}

function partOf({ value, version }: KeptPart): Part {
  const parsed: unknown = value === null ? null : JSON.parse(value);
  return { version, value: typeof parsed === "object" ? parsed : null, unanswered: 0 };
}
