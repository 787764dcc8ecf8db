/**
 * Undo and redo of the whole page, in the order in which things were changed: edits, which the engine takes back, and
 * what only the page knows: marks, clipping, how scan, slices and segments look.
 */
import type { EngineSteps } from "../state/engine_steps.svelte";
import type { PageSteps } from "../state/page_steps.svelte";
import type { Session } from "../state/session.svelte";

export class UndoControl {
  /** What was asked for, in turn: which step is the newest is known once the engine has reported all before. */
  private waiting: readonly (() => void)[] = [];

  constructor(
    private readonly session: Session,
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
    this.ask(() => {
      this.undoNewest();
    });
  }

  redo(): void {
    this.ask(() => {
      this.redoNext();
    });
  }

  private ask(what: () => void): void {
    this.waiting = [...this.waiting, what];
    if (this.waiting.length === 1) {
      this.next();
    }
  }

  private next(): void {
    this.session.whenSettled(() => {
      const [first, ...rest] = this.waiting;
      first?.();
      this.waiting = rest;
      if (rest.length > 0) {
        this.next();
      }
    });
  }

  private undoNewest(): void {
    const { engine, steps } = this;
    steps.forgetLost();
    if (steps.canUndo && (steps.toUndo !== null || !engine.canUndo)) {
      steps.undo();
    } else {
      engine.undo();
    }
  }

  private redoNext(): void {
    const { engine, steps } = this;
    steps.forgetLost();
    if (steps.canRedo && (steps.toRedo !== null || !engine.canRedo)) {
      steps.redo();
    } else {
      engine.redo();
    }
  }
}
