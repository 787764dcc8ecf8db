/** Has the engine write the surface of a segment as a mesh, and says what it keeps of the voxels. */
import type { Segment } from "../../../core/protocol";
import { fetchFile, tellSaved } from "../../state/download";
import type { Session } from "../../state/session.svelte";

export class SurfaceExport {
  /** The segment whose surface is being written; null where none is. */
  busy = $state.raw<number | null>(null);
  /** What was written of each segment. */
  private told = $state.raw<Readonly<Record<number, string>>>({});

  constructor(private readonly session: Session) {}

  /** What was written last of a segment. */
  written(id: number): string | undefined {
    return this.told[id];
  }

  async save({ id, name }: Segment): Promise<void> {
    if (this.busy !== null) {
      return;
    }
    this.busy = id;
    try {
      const file = await fetchFile("/api/surface", { segment: id }, `${name}.stl`);
      const [written = "", ...warnings] = file.notes;
      tellSaved(this.session, file.name);
      this.told = { ...this.told, [id]: written };
      for (const warning of warnings) {
        this.session.notify("warning", `${warning}.`);
      }
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      this.session.notify("error", `No surface was written: ${reason}`);
    } finally {
      this.busy = null;
    }
  }
}
