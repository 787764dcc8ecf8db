/**
 * Scissors: what lies inside or outside of a loop that is painted over the 3-D view goes out of the scan or of a
 * segment. It is shown first.
 */
import type { FreehandLine } from "../../../core/segments/cut_line";
import type { Scissors } from "../../../core/protocol";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";
import { PaintedLine } from "./painted_line.svelte";

export interface ScissorsChoice {
  readonly outside: boolean;
  /** Only near the first surface, and not right through. */
  readonly surface: boolean;
  /** How far behind the surface [mm]. */
  readonly depth: number;
}

const memory = "scissors";
const usual: ScissorsChoice = { outside: false, surface: false, depth: 10 };
/** Least and largest depth [mm]. */
export const depths = { least: 0.5, largest: 200 } as const;

export class ScissorsControl extends PaintedLine {
  choice = $state.raw<ScissorsChoice>(recall(memory, usual));
  private on = $state(false);
  private wanted = $state.raw<number | null>(null);

  constructor(private readonly session: Session) {
    super();
  }

  get armed(): boolean {
    return this.on;
  }

  /** The segment that it is cut out of; null is the scan. */
  get target(): number | null {
    return this.session.segments.some(({ id }) => id === this.wanted) ? this.wanted : null;
  }

  /** What the engine says would go; null before it has, and once its preview is gone. */
  get shown(): Scissors | null {
    const { scissors, segments } = this.session;
    const isThere = scissors?.preview === null || segments.some(({ id }) => id === scissors?.preview);
    return isThere ? scissors : null;
  }

  /** Whether there is something to be removed, also where it was cut before this page was loaded. */
  get ready(): boolean {
    return this.shown !== null && this.shown.preview !== null;
  }

  /** Waits for a loop. */
  start(): void {
    this.cancel();
    this.session.islands = null;
    this.on = true;
  }

  cancel(): void {
    this.forget();
    this.painting = null;
    this.on = false;
  }

  choose(part: Partial<ScissorsChoice>): void {
    this.choice = { ...this.choice, ...part };
    remember(memory, this.choice);
    this.ask();
  }

  /** Cuts out of a segment, or out of the scan. */
  aim(target: number | null): void {
    this.wanted = target;
    this.ask();
  }

  /** Removes what is shown. */
  remove(): void {
    if (this.ready) {
      this.session.scissors = null;
      this.session.send({ type: "end_going", removes: true });
      this.cancel();
    }
  }

  protected override taken(painted: FreehandLine | null): FreehandLine | null {
    // a loop closes by itself
    return painted === null || painted.places.length < 3 ? null : { ...painted, closed: true };
  }

  protected override ask(): void {
    const { line, choice, target } = this;
    this.hide();
    if (line !== null) {
      const { points, eye, view } = line;
      const depth = choice.surface ? choice.depth : null;
      const { outside } = choice;
      this.session.send({ type: "show_scissors", id: target, line: points, eye, view, outside, depth });
    }
  }

  protected override forget(): void {
    super.forget();
    this.hide();
  }

  private hide(): void {
    if (this.session.scissors !== null) {
      this.session.scissors = null;
      this.session.send({ type: "end_going", removes: false });
    }
  }
}
