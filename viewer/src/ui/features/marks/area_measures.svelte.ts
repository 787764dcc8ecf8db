/** Values in the ellipses and rectangles among the marks, measured by the engine whenever these or voxels change. */
import { isArea } from "../../../core/marks/area";
import type { AreaValues } from "../../../core/marks/area_values";
import type { Mark } from "../../../core/marks/measure";
import { measureAtRest } from "../../state/measured";
import type { Session } from "../../state/session.svelte";

/** So long nothing changes before they are measured [ms]. */
const rest = 120;

export class AreaMeasures {
  /** What was measured, by what it was measured of. */
  private measured = $state.raw<Readonly<Record<string, AreaValues>>>({});
  /** Why they could not be measured; null where they could. */
  failed = $state.raw<string | null>(null);
  private readonly areas = $derived.by(() => this.marks.all.filter(({ kind }) => isArea(kind)));
  /** What the values depend on: they are the same where this is. */
  readonly version = $derived.by(() => JSON.stringify([this.session.live?.edit, this.areas.map(keyOf)]));

  constructor(
    private readonly session: Session,
    private readonly marks: { readonly all: readonly Mark[] },
  ) {}

  /** Values in an area; null until they are measured where it stands now. */
  of(mark: Mark): AreaValues | null {
    return this.measured[keyOf(mark)] ?? null;
  }

  /** Measures once nothing changes any more; returns what cancels it, as effects do. */
  follow(): () => void {
    const { areas } = this;
    if (areas.length === 0) {
      return () => undefined;
    }
    return measureAtRest({
      path: "/api/areas",
      wanted: { areas: areas.map(({ kind, points }) => ({ kind, points })) },
      rest,
      take: (answer) => {
        const values = JSON.parse(answer) as readonly AreaValues[];
        const known = areas.flatMap((mark, i) => {
          const found = values[i];
          return found === undefined ? [] : [[keyOf(mark), found] as const];
        });
        this.measured = Object.fromEntries(known);
        this.failed = null;
      },
      fail: (reason) => (this.failed = reason),
    });
  }
}

function keyOf({ kind, points }: Mark): string {
  return JSON.stringify([kind, points]);
}
