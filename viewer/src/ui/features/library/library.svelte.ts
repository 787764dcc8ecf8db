/** Opens scans: looks for them, takes those that are dropped, and has the engine show one. */
import {
  layoutText,
  wholeVoxel,
  type HeaderlessFiles,
  type LaidOut,
  type GivenLayout,
} from "../../../core/library/headerless";
import { asSentence, begunLarge, formatBytes, plural } from "../../../core/base/format";
import {
  isSingle,
  refusalOf,
  type About,
  type Autosave,
  type FoundLabels,
  type GivenFile,
  type JobLine,
  type ListedScan,
  type RecentScan,
  type JobProgress,
} from "../../../core/library/library";
import { LatePictures } from "../../../core/library/late_pictures";
import type {
  AskedReconstruction,
  GeometryFile,
  Projections,
  ReconstructionGrid,
} from "../../../core/library/reconstruction";
import type { Vec3 } from "../../../core/geometry/vector";
import { askAbout, askGrid, askLayout, bring, dropUpload, forgetRecent, work } from "../../../live/library_requests";

export interface Found {
  readonly find: number;
  readonly scans: readonly ListedScan[];
}

/** How an open scan is wanted: another volume of its file, or with what its file does not tell. */
export interface Wanted {
  /** From 1. */
  readonly number?: number;
  readonly unit?: "HU";
  /** Such as "LPS". */
  readonly orientation?: string;
}

export class Library {
  /** What the engine says of itself; null before it has, undefined where it does not answer. */
  about = $state.raw<About | null | undefined>(null);
  /** Whether the page for opening lies over the open scan. */
  shown = $state.raw(false);
  /** What is opened comes beside the open scan, and not in its place. */
  beside = $state.raw(false);
  /** What is given holds segments of the open scan. */
  segments = $state.raw(false);
  /** Whether segments may lie on another grid than the scan. */
  resample = $state.raw(false);
  /** Whether segments may be of another patient, study or frame of reference. */
  anotherPatient = $state.raw(false);
  work = $state.raw<JobProgress | null>(null);
  failure = $state.raw<string | null>(null);
  /** What is kept of the scene that failed to open. */
  autosave = $state.raw<Autosave | null>(null);
  found = $state.raw<Found | null>(null);
  /** Pictures of the scans that were found, by their places in the list. */
  pictures = $state.raw<Readonly<Record<number, string>>>({});

  /** Found in the place of scans: a scan can be made of them. */
  projections = $state.raw<Projections | null>(null);
  /** Found in the place of scans: files whose layout is to be given. */
  bare = $state.raw<HeaderlessFiles | null>(null);
  /** Found in the place of scans: segments. */
  labels = $state.raw<FoundLabels | null>(null);
  /** What is given next are projections, whatever it looks like. */
  projected = $state.raw(false);

  /** How far the engine is with the scan that it was started with; null once that is there. */
  reading = $state.raw<JobProgress | null>(null);
  /** Why that cannot be shown. */
  readingFailure = $state.raw<string | null>(null);

  /** Whether a scan is being opened: another one cannot be chosen meanwhile. */
  opening = $state.raw(false);

  private late: LatePictures | null = null;
  private asking: AbortController | null = null;
  private place: object = {};

  /** What is asked of what was found; null where nothing was. */
  get title(): string | null {
    if (this.projections !== null) {
      return "Reconstruct a scan";
    }
    if (this.bare !== null) {
      return this.bare.layout === null ? "Stack of pictures" : "Raw voxels";
    }
    if (this.labels !== null) {
      return "Segments";
    }
    return this.found === null ? null : "Choose a scan";
  }

  /** @param reload shows the page anew, with the scan that is open then. */
  constructor(private readonly reload: () => void = () => { window.location.reload(); }) {}

  /** Asks what is open, and waits for what is being read. */
  async begin(): Promise<void> {
    await this.look();
    const name = this.about?.coming ?? null;
    if (name === null) {
      return;
    }
    this.reading = { what: `Reading ${name}`, share: null };
    try {
      await work("coming", {}, { signal: new AbortController().signal }, (line) => {
        if (line.kind === "progress" && line.what !== "") {
          this.reading = { what: begunLarge(line.what), share: line.share };
        }
      });
    } catch (error) {
      // the connection reports an engine that is gone
      if (!(error instanceof TypeError)) {
        this.readingFailure = asSentence(error instanceof Error ? error.message : String(error));
      }
    }
    await this.look();
    this.reading = null;
  }

  /** Asks what is open. */
  async look(): Promise<void> {
    this.about = await askAbout().catch(() => undefined);
  }

  /** Shows the page for opening over the open scan. */
  async show({ beside = false, segments = false } = {}): Promise<void> {
    if (beside !== this.beside || segments !== this.segments) {
      this.leaveList();
      this.failure = null;
      this.beside = beside;
      this.segments = segments;
    }
    this.shown = true;
    const told = this.about?.told ?? [];
    await this.look();
    if (this.about) {
      this.about = { ...this.about, told: [...told, ...this.about.told] };
    }
  }

  hide(): void {
    this.cancel();
    this.shown = false;
  }

  /** Messages that no page has shown yet, once. */
  takeMessages(): readonly string[] {
    const told = this.about?.told ?? [];
    if (this.about) {
      this.about = { ...this.about, told: [] };
    }
    return told;
  }

  cancel(): void {
    this.asking?.abort();
    this.asking = null;
    this.work = null;
    this.opening = false;
  }

  /** Back from the list. */
  leaveList(): void {
    this.cancel();
    this.clear();
  }

  private clear(): void {
    this.late?.end();
    this.late = null;
    this.found = null;
    this.projections = null;
    this.bare = null;
    this.labels = null;
    this.pictures = {};
  }

  /** Has the picture of a place in the list come, where it only comes when it is asked for. */
  wantPicture(place: number): void {
    if (this.found?.scans[place]?.late === true) {
      this.late?.want(place);
    }
  }

  /** The place is out of sight. */
  leavePicture(place: number): void {
    this.late?.leave(place);
  }

  async findAt(path: string): Promise<void> {
    await this.attempt(async (signal) => {
      await this.find({ path }, signal);
    });
  }

  /** Takes files that were dropped or chosen. */
  async give(files: Promise<readonly GivenFile[]>): Promise<void> {
    await this.attempt(async (signal) => {
      this.work = { what: "Looking at the files", share: null };
      const given = await files;
      const refused = this.about ? refusalOf(given, this.about) : null;
      if (refused !== null) {
        throw new Error(refused);
      }
      const size = given.reduce((sum, { file }) => sum + file.size, 0);
      const counted = plural(given.length, ["file", "files"]);
      const what = `Copying ${counted}, ${formatBytes(size)}`;
      this.work = { what, share: 0 };
      const upload = await bring(given, { signal }, (bytes) => {
        this.work = { what, share: size === 0 ? null : bytes / size };
      });
      await this.find({ upload }, signal);
    });
  }

  /** Opens one of the scans that were found; of segments it is asked what to do with them. */
  async open(choice: number): Promise<void> {
    const find = this.found?.find;
    const chosen = this.found?.scans[choice];
    if (chosen !== undefined && chosen.labels !== null) {
      this.place = { find, choice };
      this.labels = { name: chosen.name, what: chosen.labels, image: true };
      return;
    }
    await this.attempt((signal) => this.exchange({ find, choice }, signal));
  }

  /** Opens a scan that is made of the projections that were found. */
  async reconstruct(asked: AskedReconstruction): Promise<void> {
    await this.attempt((signal) => this.exchange(asked, signal, "reconstruct"));
  }

  /** Brings the file that states the geometry of projections. Throws why it was not taken. */
  async bringGeometry(file: File): Promise<GeometryFile> {
    const { signal } = new AbortController();
    const upload = await bring([{ name: file.name, file }], { signal }, () => undefined);
    return { name: file.name, upload };
  }

  /** The file is not wanted any more. */
  dropGeometry(file: GeometryFile): void {
    void dropUpload(file.upload);
  }

  /** The grid of the scan that would come. Throws why none would. */
  async gridOf(asked: AskedReconstruction): Promise<ReconstructionGrid> {
    return askGrid(asked);
  }

  /** The scan that files would give by a layout. Throws why they would give none. */
  async layoutOf(find: number, { layout, voxel }: GivenLayout): Promise<LaidOut> {
    return askLayout({ find, raw: layout === null ? null : layoutText(layout), voxel_size: wholeVoxel(voxel) });
  }

  /** Opens files by the layout that a person tells. */
  async openHeaderless(find: number, raw: string | null, voxel_size: Vec3): Promise<void> {
    await this.attempt((signal) => this.exchange({ find, raw, voxel_size }, signal));
  }

  /** Adds the segments that were found to the open scan. */
  async addFound(): Promise<void> {
    await this.attempt((signal) => this.addSegments(this.place, signal));
  }

  /** What was found is something else: looks at it again as that. */
  async takeAs(what: "scan" | "projections"): Promise<void> {
    this.projected = false;
    const listed = this.labels !== null && this.found !== null;
    await this.attempt((signal) => (listed ? this.exchange(this.place, signal) : this.find(this.place, signal, what)));
  }

  /** Has the open scan, or the second one, read again as it is wanted. */
  async reread(wanted: Wanted, { beside = false } = {}): Promise<void> {
    await this.attempt(async (signal) => {
      this.opening = true;
      try {
        await work("volume", { ...wanted, beside }, { signal }, this.take.bind(this));
      } finally {
        // else another one is being opened by now, or none
        if (!signal.aborted) {
          this.opening = false;
        }
      }
      if (!beside) {
        this.reload();
      }
    });
  }

  async openRecent({ path, series, frame, raw, voxel_size }: RecentScan): Promise<void> {
    await this.attempt((signal) => this.exchange({ path, series, frame, raw, voxel_size }, signal));
  }

  /** Opens the built-in phantom. */
  async openDemo(): Promise<void> {
    await this.attempt((signal) => this.exchange({ demo: true }, signal));
  }

  /** Opens the scan of a damaged scene as the last autosave has it. */
  async openAutosave(find: number): Promise<void> {
    await this.attempt((signal) => this.exchange({ find }, signal));
  }

  async forget(): Promise<void> {
    await forgetRecent();
    await this.look();
  }

  /** Lists the scans of a place, or adds its segments to the open scan. */
  private async find(
    place: object,
    signal: AbortSignal,
    taken_as = this.projected ? "projections" : "anything",
  ): Promise<void> {
    if (this.segments) {
      await this.addSegments(place, signal);
      return;
    }
    this.clear();
    this.place = place;
    await work("find", { ...place, taken_as }, { signal }, this.take.bind(this));
    const { found } = this as { found: Found | null };
    if (found !== null && isSingle(found.scans)) {
      await this.exchange({ find: found.find, choice: 0 }, signal);
    }
  }

  private async addSegments(place: object, signal: AbortSignal): Promise<void> {
    const wanted = { ...place, resample: this.resample, another_patient: this.anotherPatient };
    await work("segments", wanted, { signal }, this.take.bind(this));
    this.leaveList();
    this.hide();
  }

  private async exchange(wanted: object, signal: AbortSignal, how: "open" | "reconstruct" = "open"): Promise<void> {
    const { beside, found } = this;
    this.opening = true;
    try {
      await work(how, beside ? { ...wanted, beside } : wanted, { signal }, this.take.bind(this));
    } finally {
      // else another one is being opened by now, or none
      if (!signal.aborted) {
        this.opening = false;
      }
    }
    // a server's series may hold several volumes, such as times: they were listed instead
    if (this.found !== found) {
      return;
    }
    if (beside) {
      this.leaveList();
      this.hide();
    } else {
      this.reload();
    }
  }

  private take(line: JobLine): void {
    switch (line.kind) {
      case "progress":
        this.work = { what: begunLarge(line.what), share: line.share };
        break;
      case "found":
        this.found = line;
        this.pictures = {};
        this.late?.end();
        this.late = new LatePictures(
          (choices, signal, told) =>
            work("pictures", { find: line.find, choices }, { signal }, told),
          (each) => {
            // how far they are is of no interest
            if (each.kind === "picture") this.take(each);
          },
        );
        // what is listed can be chosen while its pictures are on their way
        this.opening = false;
        break;
      case "projections":
        this.projections = line;
        break;
      case "bare":
        this.bare = line;
        break;
      case "labels":
        this.labels = line;
        break;
      case "autosave":
        this.autosave = line;
        break;
      case "picture":
        this.pictures = { ...this.pictures, [line.choice]: `data:image/png;base64,${line.png}` };
        break;
      default:
        break;
    }
  }

  /** Does one thing at a time, and shows why it failed. */
  private async attempt(act: (signal: AbortSignal) => Promise<void>): Promise<void> {
    this.cancel();
    const asking = new AbortController();
    this.asking = asking;
    this.failure = null;
    this.autosave = null;
    this.work = { what: "Looking", share: null };
    try {
      await act(asking.signal);
    } catch (error) {
      // what was cancelled has not failed
      if (!asking.signal.aborted) {
        this.failure = asSentence(error instanceof Error ? error.message : String(error));
        void this.look();
      }
    } finally {
      if (this.asking === asking) {
        this.asking = null;
        this.work = null;
      }
    }
  }
}

/** What the page for opening is called. */
export function titleOf({ beside, segments }: Pick<Library, "beside" | "segments">): string {
  if (segments) {
    return "Add segments";
  }
  return beside ? "Add a second scan" : "Open a scan";
}
