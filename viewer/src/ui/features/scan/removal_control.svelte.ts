/**
 * What is in the way is taken out of the scan: a table, once a person has seen it, or all outside of the clip box. In a
 * CT that was opened for the first time the engine looks for a table by itself, once all else is at rest.
 */
import type { ClipBox } from "../../../core/view/clip";
import type { Session } from "../../state/session.svelte";

/** What is kept with the scan: whether a person was asked about its table. */
const part = "table";
/** How often it is looked whether all is at rest, and how often in turn it must be [ms]. */
const pace = 1000;
const rests = 3;

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

  /** Whether to ask a person about a table that the engine has found by itself. */
  readonly suggests = $derived.by(
    () => this.session.tableSuggested && this.table === null && this.session.segmentWork === null,
  );

  /**
   * Has the engine look for a table in a CT, once `atRest` has held for a while, and once for each scan.
   *
   * @returns gives it up.
   */
  suggestOnce(atRest: () => boolean): () => void {
    let rested = 0;
    const looking = setInterval(() => {
      rested = atRest() && this.session.segmentWork === null ? rested + 1 : 0;
      if (rested === rests) {
        clearInterval(looking);
        if (this.session.scan?.unit === "HU" && !this.wasAsked) {
          this.session.send({ type: "suggest_table" });
        }
      }
    }, pace);
    return () => {
      clearInterval(looking);
    };
  }

  /** Takes the table that was suggested out of the scan, or leaves it; it is not asked again. */
  decide(removes: boolean): void {
    this.session.tableSuggested = false;
    this.session.memory.keep(part, { asked: true });
    if (removes) {
      this.session.send({ type: "remove_table" });
    }
  }

  private get wasAsked(): boolean {
    // nor is a program asked that drives the page
    return this.session.memory.recall(part, { asked: navigator.webdriver }).asked;
  }

  /** Looks for a table; it is shown then, and nothing is removed yet. */
  findTable(): void {
    this.session.tableSuggested = false;
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
