/**
 * A part of what the page shows that a person changes: each change is a step of undo, a whole drag too, and what
 * holds is kept, also after undo and redo.
 */
import { deepEqual } from "../../core/base/deep_equal";
import { withChange } from "../../core/base/with_change";
import type { PageSteps, StepOwner } from "./page_steps.svelte";

export class PageState<T> implements StepOwner<T> {
  private held: T;

  /** @param keep remembers what holds now in place of what was before. */
  constructor(
    first: T,
    private readonly steps: PageSteps,
    private readonly keep: (value: T, before: T) => void,
  ) {
    this.held = $state.raw(first);
  }

  get now(): T {
    return this.held;
  }

  /** Begins anew, as with another scan: no step, and none before is of use any more. */
  open(value: T): void {
    this.steps.forget(this);
    this.held = value;
  }

  /** Has another value hold: one step under this name, or a part of one `inGesture`. */
  change(name: string, value: T, inGesture = false): void {
    const before = this.held;
    if (!deepEqual(before, value)) {
      this.hold(value, before);
      this.steps.add(this, { name, before, after: value }, inGesture);
    }
  }

  /** Has one hold in place of the other: what they have in common stays as it was changed elsewhere. */
  hold(value: T, instead: T): void {
    const before = this.held;
    this.held = withChange(before, instead, value);
    this.keep(this.held, before);
  }

  /** Takes what was changed elsewhere: no step, and kept there. */
  take(value: T): void {
    this.held = value;
  }
}
