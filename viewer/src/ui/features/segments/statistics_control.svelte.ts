/** Statistics of all segments, measured anew by the engine when they have changed. */
import { statisticsOf, type StatisticsTable } from "../../../core/segments/segment_statistics";
import { measureAtRest } from "../../state/measured";
import type { Session } from "../../state/session.svelte";

/** So long nothing changes before segments are measured [ms]. */
const rest = 400;

export class StatisticsControl {
  /** Those measured last; null where none were. */
  table = $state.raw<StatisticsTable | null>(null);
  /** Whether the table is of segments as they were before. */
  stale = $state(false);
  /** Why they could not be measured; null where they could. */
  failed = $state.raw<string | null>(null);
  /** What the numbers depend on: they are the same where this is. */
  readonly version = $derived.by(() =>
    JSON.stringify([
      this.session.live?.edit,
      this.session.segments.map(({ id, name, voxels, range, pose }) => [id, name, voxels, range, pose]),
    ]),
  );

  constructor(private readonly session: Session) {}

  /** Measures once nothing changes any more; returns what cancels it, as effects do. */
  follow(): () => void {
    this.stale = true;
    return measureAtRest({
      path: "/api/statistics",
      rest,
      take: (answer) => {
        this.table = statisticsOf(answer);
        this.failed = null;
        this.stale = false;
      },
      fail: (reason) => {
        this.failed = reason;
        this.stale = false;
      },
    });
  }
}
