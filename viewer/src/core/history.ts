/** Steps that can be taken back and made again. Pure: every change gives another history. */

export interface History<T> {
  readonly past: readonly T[];
  readonly now: T;
  readonly future: readonly T[];
}

/** Older steps are forgotten. */
const mostSteps = 100;

export function begin<T>(now: T): History<T> {
  return { past: [], now, future: [] };
}

/** A new step. */
export function advance<T>({ past, now }: History<T>, next: T): History<T> {
  return { past: [...past, now].slice(-mostSteps), now: next, future: [] };
}

export function back<T>(history: History<T>): History<T> {
  const last = history.past.at(-1);
  return last === undefined
    ? history
    : { past: history.past.slice(0, -1), now: last, future: [history.now, ...history.future] };
}

export function forth<T>(history: History<T>): History<T> {
  const [next, ...future] = history.future;
  return next === undefined ? history : { past: [...history.past, history.now], now: next, future };
}
