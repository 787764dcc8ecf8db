/**
 * How contact sounds, from the states that arrive: a soft strike where contact begins, as
 * loud as the hand was fast, and a scrape while the probe slides, as loud as it is pressed
 * and fast. Stiff surfaces sound bright and short, soft ones dull and long.
 *
 * Speeds [mm/s], forces [N], stiffness [N/mm], frequencies [Hz], gains 0..1.
 */
import type { State, ToolState } from "../protocol";
import { loadShare } from "../tools/tools";
import { dot, length, scale, subtract, type Vec3 } from "../geometry/vector";

export type Heard = Pick<State, "time" | "device" | "proxy" | "normal" | "force" | "contact">;

/** A burst of filtered noise. */
export interface Strike {
  readonly gain: number;
  /** Middle of the noise's band. */
  readonly frequency: number;
  /** Until it has faded to a hundredth [s]. */
  readonly seconds: number;
}

/** Noise that lasts until it is told otherwise. */
export interface Scrape {
  readonly gain: number;
  readonly frequency: number;
}

export interface Sound {
  readonly strike: Strike | null;
  readonly scrape: Scrape;
}

/** A hand this fast strikes as loud as it gets; a slower one than `gentle` is not heard. */
const fastStrike = 250;
const gentle = 2;
/** Contact that was lost for a shorter time than this begins no new strike [s]. */
const shortestPause = 0.06;
/** Sliding this fast with this force scrapes as loud as it gets. */
const fastScrape = 120;
const firmScrape = 4;
const slowestScrape = 1.5;
/** The scrape stays under the strikes. */
const scrapeShare = 0.3;

const softest = { stiffness: 0.05, frequency: 170, seconds: 0.16 } as const;
const stiffest = { stiffness: 5, frequency: 2400, seconds: 0.05 } as const;

export function clamp01(value: number): number {
  return Number.isFinite(value) ? Math.min(1, Math.max(0, value)) : 0;
}

/** Where a stiffness lies between the softest and the stiffest, in equal ratios, 0..1. */
function brightness(stiffness: number): number {
  return clamp01(Math.log(stiffness / softest.stiffness) / Math.log(stiffest.stiffness / softest.stiffness));
}

function between(low: number, high: number, share: number): number {
  return low * (high / low) ** share;
}

export class ContactSound {
  private before: Heard | null = null;
  private touchedAt = -Infinity;

  /** What is heard of a state, after those before it. */
  next(now: Heard, stiffness: number): Sound {
    const before = this.before;
    const seconds = before === null ? 0 : now.time - before.time;
    const begins = now.contact && now.time - this.touchedAt >= shortestPause;
    this.before = now;
    this.touchedAt = now.contact ? now.time : Math.min(this.touchedAt, now.time);
    // after a pause, or in a new session, nothing is known of the speed
    if (before === null || seconds <= 0 || seconds > 0.5) {
      return { strike: null, scrape: { gain: 0, frequency: softest.frequency } };
    }
    const speedOf = (point: "device" | "proxy"): Vec3 => scale(subtract(now[point], before[point]), 1 / seconds);
    return {
      strike: begins ? strikeOf(-dot(speedOf("device"), now.normal), stiffness) : null,
      scrape: scrapeOf(now.contact && before.contact ? slidingSpeed(speedOf("proxy"), now.normal) : 0, now, stiffness),
    };
  }
}

/** A drill that runs free, and how much louder and lower it is under load. */
const drilling = { gain: 0.06, loaded: 0.24, frequency: 1500, slowed: 0.55 } as const;

/** The sound with a drill in it that runs: it hums, louder and lower the more it is loaded. */
export function withDrill(sound: Sound, tool: Pick<ToolState, "kind" | "on" | "load">): Sound {
  if (tool.kind !== "drill" || !tool.on) {
    return sound;
  }
  const share = Math.sqrt(loadShare(tool));
  const gain = drilling.gain + drilling.loaded * share;
  return { ...sound, scrape: { gain, frequency: drilling.frequency * (1 - drilling.slowed * share) } };
}

/** @param approach speed of the hand into the surface. */
function strikeOf(approach: number, stiffness: number): Strike | null {
  if (!(approach >= gentle)) {
    return null;
  }
  const bright = brightness(stiffness);
  return {
    // heard loudness grows slower than speed
    gain: clamp01(approach / fastStrike) ** 0.6,
    frequency: between(softest.frequency, stiffest.frequency, bright),
    seconds: between(softest.seconds, stiffest.seconds, bright),
  };
}

function slidingSpeed(velocity: Vec3, normal: Vec3): number {
  return length(subtract(velocity, scale(normal, dot(velocity, normal))));
}

function scrapeOf(sliding: number, { force }: Heard, stiffness: number): Scrape {
  const fast = clamp01(sliding / fastScrape);
  const firm = clamp01(length(force) / firmScrape);
  const gain = sliding < slowestScrape ? 0 : scrapeShare * Math.sqrt(fast * firm);
  const frequency = between(softest.frequency, stiffest.frequency, brightness(stiffness));
  // a faster finger hisses higher
  return { gain, frequency: frequency * (0.8 + 0.9 * fast) };
}
