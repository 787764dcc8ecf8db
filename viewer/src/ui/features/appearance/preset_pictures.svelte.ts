/** Small pictures of the scan in each preset, drawn by the engine once they are looked for. */
import { job } from "../../../live/job";

export class PresetPictures {
  /** Addresses of the pictures that came, by the names of presets. */
  private pictures = $state.raw<Readonly<Record<string, string>>>({});
  /** What they were drawn of: a scan, after so many edits. */
  private drawn: { readonly scan: object | null; readonly edit: number } = { scan: null, edit: 0 };
  private asked: readonly string[] = [];
  private leaving = new AbortController();

  /** Address of a preset's picture; null while there is none. */
  of(name: string): string | null {
    return this.pictures[name] ?? null;
  }

  /** Wants pictures of a scan, after so many edits, in presets that were not asked for yet. */
  want(scan: object, edit: number, names: readonly string[]): void {
    if (scan !== this.drawn.scan || edit !== this.drawn.edit) {
      this.leaving.abort();
      this.leaving = new AbortController();
      this.drawn = { scan, edit };
      this.asked = [];
      this.pictures = {};
    }
    const presets = names.filter((name) => !this.asked.includes(name));
    this.asked = [...this.asked, ...presets];
    if (presets.length > 0) {
      const { signal } = this.leaving;
      void job("/api/presets", { presets }, { signal }, (line) => {
        if (line.kind === "preset" && !signal.aborted) {
          this.pictures = { ...this.pictures, [line.preset]: `data:image/png;base64,${line.png}` };
        }
        // without its picture a preset is shown by its colours
      }).catch(() => undefined);
    }
  }
}
