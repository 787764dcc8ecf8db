/**
 * Undo and redo of the whole page, in the order in which things were changed: edits, which the engine takes back, and
 * what only the page knows: marks, clipping, how scan, slices and segments look.
 */
import type { EngineSteps } from "./engine_steps.svelte";
import type { PageSteps } from "./page_steps.svelte";

export class UndoControl {
  constructor(
    private readonly engine: EngineSteps,
    private readonly steps: PageSteps,
  ) {}

  get canUndo(): boolean {
    return this.steps.canUndo || this.engine.canUndo;
  }

  get canRedo(): boolean {
    return this.steps.canRedo || this.engine.canRedo;
  }

  /** What would be taken back or made again, where the page knows its name. */
  get toUndo(): string | null {
    return this.steps.toUndo;
  }

  get toRedo(): string | null {
    return this.steps.toRedo;
  }

  undo(): void {
    const { engine, steps } = this;
    steps.forgetLost();
    if (steps.canUndo && (steps.toUndo !== null || !engine.canUndo)) {
      steps.undo();
    } else {
      engine.undo();
    }
  }

  redo(): void {
    const { engine, steps } = this;
    steps.forgetLost();
    if (steps.canRedo && (steps.toRedo !== null || !engine.canRedo)) {
      steps.redo();
    } else {
      engine.redo();
    }
  }
}
