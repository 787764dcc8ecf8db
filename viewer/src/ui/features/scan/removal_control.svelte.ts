/**
 * What is in the way is taken out of the scan: a table, once a person has seen it, or all outside of the clip box.
 */
import type { ClipBox } from "../../../core/view/clip";
import type { Session } from "../../state/session.svelte";

export class RemovalControl {
  constructor(private readonly session: Session) {}

  /** The table that was found, until a person has decided; null where there is none. */
  readonly table = $derived.by(() =>
    this.session.segments.find(({ id, voxels }) => id === this.session.tableFound && voxels > 0) ?? null,
  );

  /** Whether a scan like this one can have a table in it: a CT, as far as that is known. */
  readonly isLikely = $derived.by(() => {
    const scan = this.session.scan;
    return scan !== null && (scan.unit === "HU" || scan.modality === "CT" || scan.modality === "");
  });

  /** Looks for a table; it is shown then, and nothing is removed yet. */
  findTable(): void {
    this.session.send({ type: "find_table" });
  }

  /** Takes the table that is shown out of the scan. */
  removeTable(): void {
    if (this.table !== null) {
      this.session.send({ type: "remove_from_scan", id: this.table.id });
      this.session.tableFound = null;
    }
  }

  /** Leaves the scan as it is. */
  keepTable(): void {
    if (this.table !== null) {
      this.session.send({ type: "remove_segment", id: this.table.id });
      this.session.tableFound = null;
    }
  }

  /** Takes all outside of the clip box out of the scan. */
  crop({ low, high }: ClipBox): void {
    this.session.send({ type: "crop_scan", low, high });
  }
}
