/** Has the engine write segments or scan for other programs, and the browser keep the file. */
import { fetchFile, RefusedError, tellSaved, type KeptFile } from "../../state/download";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";

export const formats = [
  {
    name: "slicer",
    label: "Segments for 3D Slicer",
    kind: "seg-nrrd",
    fromDicom: false,
    says: "A .seg.nrrd with names, colours, codes and overlaps.",
  },
  {
    name: "labels",
    label: "Segments as NIfTI labels",
    kind: "labels",
    fromDicom: false,
    says: "A zip with the label map and a table of names.",
  },
  {
    name: "scan",
    label: "Scan with edits, NIfTI",
    kind: "scan",
    fromDicom: false,
    says: "The values as the tools have left them.",
  },
  {
    name: "share",
    label: "De-identified DICOM",
    kind: "dicom",
    fromDicom: true,
    says: "A zip with scan, SEG and RTSTRUCT, de-identified together: their references hold.",
  },
  {
    name: "scene",
    label: "Scene to share",
    kind: "scene",
    fromDicom: false,
    says: "A .palpate with scan, segments and marks, without paths, identifiers and names of people.",
  },
  {
    name: "seg",
    label: "DICOM SEG (names the patient)",
    kind: "dicom-seg",
    fromDicom: true,
    says: "For the archive: refers to the scan in it.",
  },
  {
    name: "labelmap",
    label: "DICOM label map (names the patient)",
    kind: "dicom-labelmap",
    fromDicom: true,
    says: "For the archive; segments may not overlap.",
  },
  {
    name: "rtstruct",
    label: "RTSTRUCT (names the patient)",
    kind: "rtstruct",
    fromDicom: true,
    says: "For the archive: outlines in each slice.",
  },
] as const;

export type Format = (typeof formats)[number];

export class Exporter {
  busy = $state.raw(false);
  /** Names to share segments by, by their ids, where they are others than those that they have. */
  names = $state.raw<Readonly<Record<number, string>>>({});
  /** Whether the engine wants a person to look for text in the images first. */
  asksForLook = $state.raw(false);
  /** Whether the person says that they have. */
  looked = $state.raw(false);
  /** Whether the person says that no name of a segment or mark names anybody. */
  namesLooked = $state.raw(false);
  private chosen = $state.raw(recall("export", { format: "slicer" }).format);
  /** What is exported: what was chosen last, where that can be made of this scan. */
  readonly format: Format = $derived.by(
    () => formats.find((format) => format.name === this.chosen && this.canMake(format)) ?? formats[0],
  );

  /** @param view what the page shows, as scenes keep it. */
  constructor(
    private readonly session: Session,
    private readonly view: () => Readonly<Record<string, unknown>>,
  ) {}

  /** Why nothing in DICOM can refer to the scan; null where something may. */
  get noDicom(): string | null {
    return this.session.scan?.no_dicom ?? null;
  }

  /** Names of segments as they would be shared. */
  get sharedNames(): readonly { readonly id: number; readonly name: string; readonly shared: string }[] {
    return this.session.segments.map(({ id, name }) => ({ id, name, shared: this.names[id] ?? name }));
  }

  rename(id: number, shared: string): void {
    this.names = { ...this.names, [id]: shared };
  }

  canMake({ fromDicom }: Format): boolean {
    return !fromDicom || this.noDicom === null;
  }

  choose(name: string): void {
    this.chosen = name;
    remember("export", { format: name });
  }

  async export(): Promise<void> {
    if (this.busy) {
      return;
    }
    this.busy = true;
    const { label } = this.format;
    try {
      const { name, notes } = await this.fetch(this.format);
      tellSaved(this.session, name);
      for (const note of notes) {
        this.session.notify("warning", `${label}: ${note}.`);
      }
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      this.asksForLook ||= error instanceof RefusedError && error.canBeConfirmed;
      this.session.notify("error", `Nothing was exported: ${reason}`);
    } finally {
      this.busy = false;
    }
  }

  private fetch({ kind }: Format): Promise<KeptFile> {
    if (kind === "scene") {
      const looked = { names_checked: this.namesLooked, pixels_checked: this.looked };
      return fetchFile("/api/scene/shared", { view: this.view(), ...looked }, "shared.palpate");
    }
    const shared = kind === "dicom" ? { names: this.names, pixels_checked: this.looked } : {};
    return fetchFile("/api/export", { kind, ...shared }, "export");
  }
}
