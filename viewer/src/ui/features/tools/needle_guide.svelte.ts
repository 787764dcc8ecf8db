/** What guides a needle: the path that was planned for it among the marks. */
import type { Mark } from "../../../core/marks/measure";
import type { NeedlePlan } from "../../../core/tools/needle_plan";

export class NeedleGuide {
  /** The path that was chosen; null for the newest one. */
  private chosen = $state.raw<number | null>(null);

  constructor(private readonly marks: { readonly all: readonly Mark[] }) {}

  /** All planned paths. */
  readonly paths = $derived.by((): readonly Mark[] => this.marks.all.filter(({ kind }) => kind === "path"));

  /** The path that the needle is to take; null where none is planned. */
  get path(): Mark | null {
    return this.paths.find(({ id }) => id === this.chosen) ?? this.paths.at(-1) ?? null;
  }

  get plan(): NeedlePlan | null {
    const { path } = this;
    // a path has two points: marks are checked where they come from
    return path?.visible === true ? (path.points as unknown as NeedlePlan) : null;
  }

  choose(id: number): void {
    this.chosen = id;
  }
}
