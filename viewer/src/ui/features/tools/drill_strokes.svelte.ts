/**
 * What each stroke of the drill has done, for the report.
 */
import { StrokeMeter, strokesTable, type StrokeReport } from "../../../core/tools/stroke_report";
import { saveFile } from "../../state/download";
import type { Session } from "../../state/session.svelte";

export class DrillStrokes {
  /** Of strokes that have ended, oldest first. */
  all = $state.raw<readonly StrokeReport[]>([]);
  private readonly meter = new StrokeMeter();

  constructor(private readonly session: Session) {
    session.onState((state) => {
      const ended = this.meter.take(state);
      if (ended !== null) {
        this.all = [...this.all, ended];
      }
    });
  }

  /** The stroke in progress, else the last one, at a pace that can be read. */
  readonly now = $derived.by((): StrokeReport | null => {
    // changes with what is shown
    void this.session.live;
    void this.all;
    return this.meter.now;
  });

  /** A table of all strokes. */
  get table(): string {
    return strokesTable(this.all);
  }

  /** Has the browser keep the table, and says so. */
  save(): void {
    const name = `${this.session.scan?.name ?? "scan"}-drilling.csv`;
    saveFile(this.session, new Blob([this.table], { type: "text/csv" }), name);
  }
}
