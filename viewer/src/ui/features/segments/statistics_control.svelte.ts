/** Statistics of all segments, measured anew by the engine when they have changed. */
import { statisticsOf, type StatisticsTable } from "../../../core/segments/segment_statistics";
import { apiAddress } from "../../../live/connection";
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

  constructor(
    private readonly session: Session,
    private readonly token: string,
  ) {}

  /** Measures once nothing changes any more; returns what cancels it, as effects do. */
  follow(): () => void {
    const cancelled = new AbortController();
    this.stale = true;
    const begun = setTimeout(() => void this.measure(cancelled.signal), rest);
    return () => {
      clearTimeout(begun);
      cancelled.abort();
    };
  }

  private async measure(signal: AbortSignal): Promise<void> {
    try {
      const answer = await fetch(apiAddress("/api/statistics", this.token), { method: "POST", signal });
      const said = await answer.text();
      if (!answer.ok) {
        throw new Error(said);
      }
      this.table = statisticsOf(said);
      this.failed = null;
      this.stale = false;
    } catch (error) {
      if (!signal.aborted) {
        this.failed = error instanceof Error ? error.message : String(error);
        this.stale = false;
      }
    }
  }
}
