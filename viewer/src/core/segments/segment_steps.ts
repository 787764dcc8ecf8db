/** The steps of a segment, as the page lists and changes them. */
import type { SegmentStep, WantedStep } from "../protocol";
import { choiceOf, type Amount } from "./segment_shapes";

/** What the list says of a kind of step. */
export interface StepWords {
  readonly name: string;
  readonly does: string;
  readonly amount: Amount | null;
}

const byHand: StepWords = {
  name: "Edited by hand",
  does: "What was painted, erased, drilled or taken out: it stays on top of what the steps before make",
  amount: null,
};

export function wordsOf({ kind, other }: Pick<SegmentStep, "kind" | "other">): StepWords {
  if (kind === "by-hand") {
    return byHand;
  }
  const { name, does, amount } = choiceOf(kind);
  return other === null
    ? { name, does, amount }
    : { name: `${name} ${other}`, does: `${does}, as ${other} was when this was done`, amount };
}

/** The list as it is, each step where it stands. */
export function wantedSteps(steps: readonly SegmentStep[]): WantedStep[] {
  return steps.map(({ kind, amount, on }, index) => ({ index, kind, amount, on }));
}

export function withChange(
  steps: readonly SegmentStep[],
  place: number,
  part: Partial<Pick<WantedStep, "amount" | "on">>,
): WantedStep[] {
  return wantedSteps(steps).map((step) => (step.index === place ? { ...step, ...part } : step));
}

export function withoutStep(steps: readonly SegmentStep[], place: number): WantedStep[] {
  return wantedSteps(steps).filter(({ index }) => index !== place);
}

/** The list with one step before the one that stands before it now. */
export function movedUp(steps: readonly SegmentStep[], place: number): WantedStep[] {
  const wanted = wantedSteps(steps);
  wanted.splice(Math.max(0, place - 1), 0, ...wanted.splice(place, 1));
  return wanted;
}

function inSentence(step: SegmentStep): string {
  const { name } = wordsOf(step);
  return step.kind === "by-hand" ? "what was edited by hand" : name.charAt(0).toLowerCase() + name.slice(1);
}

/** What follows a threshold, in words for the line below its slider; "" where nothing does. */
export function followingWords(steps: readonly SegmentStep[]): string {
  return steps
    .filter(({ on }) => on)
    .map(inSentence)
    .join(", ");
}
