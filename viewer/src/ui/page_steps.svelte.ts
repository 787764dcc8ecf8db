/**
 * The order in which the page's own steps were made, of marks and of clipping: what was changed last is taken
 * back first. Each owner keeps its steps; what the engine changes is not among them.
 */

/** Takes back its own last step, and makes it again. */
export interface StepOwner {
  undo(): void;
  redo(): void;
}

/** Older steps are forgotten; owners keep at least as many each. */
const mostSteps = 100;

export class PageSteps {
  private past = $state.raw<readonly StepOwner[]>([]);
  private future = $state.raw<readonly StepOwner[]>([]);
  /** Number of the engine's last edit when a step was made or taken back last. */
  private changedAt = -1;

  /** @param lastEdit number of the engine's last edit. */
  constructor(private readonly lastEdit: () => number) {}

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /** Whether nothing was edited since: then the page's own step is taken back first. */
  get changedLast(): boolean {
    return this.changedAt === this.lastEdit();
  }

  /** An owner has made a step. */
  add(owner: StepOwner): void {
    this.past = [...this.past, owner].slice(-mostSteps);
    this.future = [];
    this.changedAt = this.lastEdit();
  }

  /** The engine was asked for a step that changes no voxel: that one is taken back first. */
  engineAsked(): void {
    this.changedAt = -1;
  }

  /** Another scan: nothing can be taken back. */
  clear(): void {
    this.past = [];
    this.future = [];
    this.changedAt = -1;
  }

  undo(): void {
    const owner = this.past.at(-1);
    if (owner !== undefined) {
      this.past = this.past.slice(0, -1);
      this.future = [owner, ...this.future];
      this.changedAt = this.lastEdit();
      owner.undo();
    }
  }

  redo(): void {
    const [owner, ...rest] = this.future;
    if (owner !== undefined) {
      this.past = [...this.past, owner];
      this.future = rest;
      this.changedAt = this.lastEdit();
      owner.redo();
    }
  }
}
