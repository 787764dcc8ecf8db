/**
 * Steps of undo that only the page knows: marks, clipping, how scan, slices and segments look. Each holds what was and
 * what is, and its owner puts one in place of the other. Steps of the engine are not among them, but each
 * of these knows how many came before it: so both are taken back in one order.
 */
import { deepEqual } from "../../core/base/deep_equal";

/** Holds what steps change. */
export interface StepOwner<T> {
  /** Has one hold in place of the other: what a step has changed, and nothing else. */
  hold(value: T, instead: T): void;
  /** Whether anything of it still holds, for what others may change; all does where this is left out. */
  stands?(value: T): boolean;
}

/** A change as the undo button names it, with what was before it and what is after it. */
export interface Change<T> {
  readonly name: string;
  readonly before: T;
  readonly after: T;
}

interface PageStep extends Change<unknown> {
  readonly owner: StepOwner<unknown>;
  /** How many steps the engine had made when this one was made, taken back or made again last. */
  readonly at: number;
}

/** Older steps are forgotten. */
const mostSteps = 200;

export class PageSteps {
  private past = $state.raw<readonly PageStep[]>([]);
  private future = $state.raw<readonly PageStep[]>([]);
  /** The last step is a part of a gesture that may go on. */
  private goesOn = false;

  /** @param engineSteps how many steps the engine has made, less those that were taken back. */
  constructor(private readonly engineSteps: () => number) {}

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /** The step that comes before all of the engine's; null where one of the engine's comes first, or there is none. */
  get toUndo(): string | null {
    const step = this.past.at(-1);
    return step !== undefined && step.at >= this.engineSteps() ? step.name : null;
  }

  get toRedo(): string | null {
    const step = this.future[0];
    return step !== undefined && step.at <= this.engineSteps() ? step.name : null;
  }

  /** A change is one step; those of one name in one gesture are one together. */
  add<T>(owner: StepOwner<T>, change: Change<T>, inGesture = false): void {
    const last = this.past.at(-1);
    const joins =
      inGesture && this.goesOn && last?.owner === owner && last.name === change.name && last.at === this.engineSteps();
    const step = { ...change, before: joins ? last.before : change.before, owner, at: this.engineSteps() };
    const rest = joins ? this.past.slice(0, -1) : this.past;
    this.past = deepEqual(step.before, step.after) ? rest : [...rest, step].slice(-mostSteps);
    this.future = [];
    this.goesOn = inGesture;
  }

  /** A gesture ends: the next change is a step of its own. */
  endGesture(): void {
    this.goesOn = false;
  }

  /** It does not end yet, as with a key that is held. */
  resumeGesture(): void {
    this.goesOn = true;
  }

  /** What an owner's steps have changed is there no more. */
  forget<T>(owner: StepOwner<T>): void {
    this.past = this.past.filter((step) => step.owner !== owner);
    this.future = this.future.filter((step) => step.owner !== owner);
  }

  /** The engine has so few steps left: what it makes next is newer than all that is here. */
  fallBack(engineSteps: number): void {
    this.past = this.past.map((step) => ({ ...step, at: Math.min(step.at, engineSteps) }));
  }

  /** A step was made elsewhere: what was taken back is not made again. */
  forgetUndone(): void {
    this.future = [];
  }

  /** Leaves out the next steps of which nothing holds any more: others have changed it since. */
  forgetLost(): void {
    while (isLost(this.past.at(-1), "after")) {
      this.past = this.past.slice(0, -1);
    }
    while (isLost(this.future[0], "before")) {
      this.future = this.future.slice(1);
    }
  }

  /** Another scan: nothing can be taken back. */
  clear(): void {
    this.past = [];
    this.future = [];
  }

  undo(): void {
    const step = this.past.at(-1);
    if (step !== undefined) {
      this.past = this.past.slice(0, -1);
      this.future = [{ ...step, at: this.engineSteps() }, ...this.future];
      this.goesOn = false;
      step.owner.hold(step.before, step.after);
    }
  }

  redo(): void {
    const [step, ...rest] = this.future;
    if (step !== undefined) {
      this.past = [...this.past, { ...step, at: this.engineSteps() }];
      this.future = rest;
      this.goesOn = false;
      step.owner.hold(step.after, step.before);
    }
  }
}

function isLost(step: PageStep | undefined, side: "before" | "after"): boolean {
  return step?.owner.stands?.(step[side]) === false;
}
