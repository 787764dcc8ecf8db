/** Two fingers on a touch screen: how far they went together, and how far apart. */
export interface PairMove {
  /** Of the point midway between both [pixels]. */
  readonly x: number;
  readonly y: number;
  /** How many times as far apart they are as before. */
  readonly spread: number;
  /** The point midway between both now, as of `put` and `move` [pixels]. */
  readonly middle: readonly [number, number];
}

type Place = readonly [number, number];

/** Closer together than this they count as one: two touches of a fingertip would have the picture jump [pixels]. */
const nearest = 10;

/** Follows the fingers on a touch screen, each by the number of its pointer. */
export class FingerPair {
  private readonly places = new Map<number, Place>();

  /** How many fingers are down. */
  get count(): number {
    return this.places.size;
  }

  put(finger: number, place: Place): void {
    this.places.set(finger, place);
  }

  lift(finger: number): void {
    this.places.delete(finger);
  }

  /** A finger is there now: what that is for both. Null where it is none of two. */
  move(finger: number, place: Place): PairMove | null {
    const before = this.pair();
    if (!this.places.has(finger)) {
      return null;
    }
    this.places.set(finger, place);
    const now = this.pair();
    if (before === null || now === null) {
      return null;
    }
    const [was, is] = [middleOf(before), middleOf(now)];
    return { x: is[0] - was[0], y: is[1] - was[1], spread: apart(now) / apart(before), middle: is };
  }

  private pair(): readonly [Place, Place] | null {
    const [first, second, third] = this.places.values();
    return first === undefined || second === undefined || third !== undefined ? null : [first, second];
  }
}

function middleOf([first, second]: readonly [Place, Place]): Place {
  return [(first[0] + second[0]) / 2, (first[1] + second[1]) / 2];
}

function apart([first, second]: readonly [Place, Place]): number {
  return Math.max(nearest, Math.hypot(second[0] - first[0], second[1] - first[1]));
}
