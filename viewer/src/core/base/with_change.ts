/** Changes that were made side by side. */
import { deepEqual } from "./deep_equal";

interface Numbered {
  readonly id: number;
}

/**
 * What holds `now`, with all that differs between `before` and `after`, and nothing else: parts of an object by their
 * names, things of a list by their numbers. Anything else is `after` as a whole.
 */
export function withChange<T>(now: T, before: T, after: T): T {
  if (deepEqual(now, before)) {
    return after;
  }
  if (areNumbered(now) && areNumbered(before) && areNumbered(after)) {
    return numberedWithChange(now, before, after) as T;
  }
  if (isRecord(now) && isRecord(before) && isRecord(after)) {
    const changed = Object.entries(after).filter(([name, value]) => !deepEqual(before[name], value));
    return { ...now, ...Object.fromEntries(changed) };
  }
  return after;
}

function numberedWithChange(
  now: readonly Numbered[],
  before: readonly Numbered[],
  after: readonly Numbered[],
): readonly Numbered[] {
  const [was, is] = [byNumber(before), byNumber(after)];
  const held = now.flatMap((thing) => {
    const { id } = thing;
    const untouched = deepEqual(was.get(id), is.get(id));
    const changed = is.get(id);
    return untouched ? [thing] : changed === undefined ? [] : [changed];
  });
  const added = after.filter(({ id }) => !was.has(id) && !now.some((thing) => thing.id === id));
  return [...held, ...added];
}

function byNumber(things: readonly Numbered[]): ReadonlyMap<number, Numbered> {
  return new Map(things.map((thing) => [thing.id, thing]));
}

function isRecord(value: unknown): value is Readonly<Record<string, unknown>> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function areNumbered(value: unknown): value is readonly Numbered[] {
  return Array.isArray(value) && value.every((each) => isRecord(each) && typeof each["id"] === "number");
}
