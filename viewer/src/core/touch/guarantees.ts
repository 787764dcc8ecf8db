/**
 * The light that says whether what touch promises holds, in words.
 *
 * Green: every guarantee has held since the start, and nothing stands between the contact
 * and the hand. Amber: they have held, and the safety stage holds the force back now. Red:
 * a guarantee was broken since the start; nothing turns it green again but a new start. What
 * an engine told that no longer answers is amber too: nobody knows what holds now.
 */
import { formatCount, plural } from "../base/format";
import type { Safety, Segment, Settings } from "../protocol";

export type LightColour = "green" | "amber" | "red";

export interface Count {
  readonly name: string;
  readonly meaning: string;
  readonly count: number;
}

export interface Light {
  readonly colour: LightColour;
  /** A few words for the status bar. */
  readonly short: string;
  /** What it means, in a sentence or two. */
  readonly meaning: string;
  /** What is counted since the start. */
  readonly counts: readonly Count[];
}

const held: Readonly<Record<Safety["force"], { short: string; meaning: string } | null>> = {
  on: null,
  waiting: {
    short: "force waits",
    meaning: "The force waits until it would be small: it never begins with a blow. Move the hand out of the surface.",
  },
  ramping: {
    short: "force ramps up",
    meaning: "The force rises to its full size within a moment, as after each start.",
  },
  easing: { short: "force eases off", meaning: "The force falls to what the motors of the device bear for long." },
  off: {
    short: "force off",
    meaning: "No force is sent to the hand: the device, or the engine's watchdog, has stopped it.",
  },
};

const noForce: Readonly<Record<NonNullable<Safety["off"]>, string>> = {
  "not-started": "No force was computed yet.",
  waiting: "The force that is wanted was never small since the start: the hand must come out of the surface first.",
  "servo-late": "The newest force is too old to be sent: the computation is late, the computer may be too busy.",
  stopped: "The session has ended.",
  "not-finite": "The force that is wanted is no number.",
};

/** Why no force is sent, in a sentence; none while forces are. */
export function whyNoForce(safety: Safety): string | null {
  return safety.off === null ? null : noForce[safety.off];
}

/** What the light shows for the counters of the safety stage; `isOld` are those of a silent engine. */
export function lightOf(safety: Safety, model: Settings["model"], isOld = false): Light {
  const counts = countsOf(safety);
  if (safety.violations > 0) {
    // @texts
    const times = safety.violations === 1 ? "once" : `${formatCount(safety.violations)} times`;
    const short = plural(safety.violations, ["failed check", "failed checks"]);
    const cause = model === "exact" ? "This is a fault of Palpate: please record and report it." : printedModel;
    return {
      colour: "red",
      short,
      meaning:
        `A force check failed ${times} since the start: the probe was inside of something solid, or a ` +
        `force was wrong. ${cause}`,
      counts,
    };
  }
  if (isOld) {
    return { colour: "amber", ...silent, counts };
  }
  const intervention = held[safety.force];
  if (intervention !== null) {
    return { colour: "amber", ...intervention, counts };
  }
  const meaning =
    model === "exact"
      ? "Each tick was looked at: the probe was never inside of anything solid, no force pulled into it, none was " +
        "without contact, and none that was sent was over the limit."
      : `No force check has failed so far. ${printedModel}`;
  return { colour: "green", short: "Force checks passed", meaning, counts };
}

const silent = {
  short: "Not answering",
  meaning: "Palpate does not answer: force, contact and counts are the last that are known.",
};

const printedModel = "The thesis' models, as printed, promise nothing; “exact” passes all of them.";

function countsOf(safety: Safety): readonly Count[] {
  return [
    { name: "Violations", meaning: "force checks that failed", count: safety.violations },
    { name: "Clamped", meaning: "forces cut to the limit", count: safety.clamped },
    { name: "Slewed", meaning: "forces that rose too fast and were slowed", count: safety.slewed },
    { name: "Damped", meaning: "forces damped to keep the device calm", count: safety.damped },
    { name: "Waited", meaning: "times the force waited to be small", count: safety.waited },
    { name: "Ramped", meaning: "times the force was faded in", count: safety.ramped },
    { name: "Eased", meaning: "times the force was faded out", count: safety.eased },
    { name: "Not finite", meaning: "forces that were no number, sent as none", count: safety.not_finite },
    { name: "Watchdog", meaning: "times the servo was late and the force went off", count: safety.watchdog },
  ];
}

/** What waits until the probe is out of its way, one line each. */
export function pendingLines(segments: readonly Segment[], pending: number): readonly string[] {
  const named = segments.filter((segment) => segment.pending).map((segment) => `A change of ${segment.name}`);
  const others = pending - named.length;
  if (others <= 0) {
    return named;
  }
  return named.length > 0
    ? [...named, plural(others, ["more change", "more changes"])]
    : [plural(others, ["change", "changes"])];
}
