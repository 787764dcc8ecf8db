/**
 * Brings a scan to the page, a large one coarsely first and finer as it arrives, and tells how far that is.
 */
import type { Arrival } from "../../../core/scan/loading_scan";
import type { BrickRanges } from "../../../core/scan/bricks";
import type { Scan } from "../../../core/protocol";
import { frameOf, type ScanFrame, type ScanVolume } from "../../../core/scan/scan_volume";
import { previewStep, subsamplingStep } from "../../../core/scan/subsampling";
import type { Picture } from "../../../gl/picture/picture";
import { downloadVolume, type Meanwhile } from "../../../live/volume_download";
import type { ShownParts } from "../../../live/volume_messages";
import type { JobProgress } from "../../../core/library/library";
import type { HeldScan } from "./shown_edits.svelte";

/** Most values of a scan that are taken to the GPU: 1 GiB in 16 bit. */
export const mostValues = 2 ** 29;

/** What is asked of the rest of the page. */
interface Outside {
  /** Longest edge of a 3-D texture. */
  readonly largestEdge: number;
  /** Shows a scan for the time being; false where nothing can be shown yet. */
  readonly preview: (volume: ScanVolume, bricks: BrickRanges, scan: Scan) => boolean;
  /** Shows what has arrived of it. */
  readonly refine: (volume: ScanVolume, arrival: Arrival) => void;
  /** How often that is done, and when. */
  readonly shownParts: ShownParts;
  /** Shows all of a scan, which is held from now on. */
  readonly show: (held: HeldScan, scan: Scan) => void;
  readonly warn: (text: string) => void;
}

export class ScanLoader {
  /** How far the engine is with reading it; null once it has. */
  reading = $state.raw<JobProgress | null>(null);
  /** Share of the scan on its way to the picture, 0..1; null once it is shown. */
  progress = $state.raw<number | null>(0);
  /** What a person should know of a scan that is too large for the GPU. */
  coarseness = $state.raw<string | null>(null);
  /** Why the scan cannot be shown. */
  failure = $state.raw<string | null>(null);
  /** A coarse picture stands for the scan that is on its way. */
  previewed = $state.raw(false);
  /** When the first picture stood on the screen, of a large scan a coarse one [ms since the page was opened]. */
  firstPicture = $state.raw<number | null>(null);
  /** When that of all of the scan did. */
  wholePicture = $state.raw<number | null>(null);

  /** The scan as the page holds it; null until all of it is here. */
  held: HeldScan | null = null;

  private request = 0;
  /** Called once the coarse picture stands on the screen. */
  private previewShown: (() => void) | null = null;

  constructor(private readonly outside: Outside) {}

  /** Downloads a scan and has it shown. */
  async open(scan: Scan): Promise<void> {
    const request = ++this.request;
    const frame = frameOf(scan);
    const { largestEdge } = this.outside;
    this.progress = 0;
    this.failure = null;
    this.previewed = false;
    // edits that arrive from now on are for this scan: they wait for it
    this.held = null;
    const step = subsamplingStep(frame.dimensions, { edge: largestEdge, values: mostValues });
    this.tellCoarseness(step);
    try {
      const coarse = await this.showCoarsely(scan, frame, step, request);
      if (request !== this.request) {
        return;
      }
      const held = await downloadVolume(frame, step, {
        progress: (share) => {
          this.progress = request === this.request ? 0.9 * share : this.progress;
        },
        ...(coarse === null ? {} : { meanwhile: this.refining(coarse, request) }),
      });
      if (request === this.request) {
        this.held = held;
        this.outside.show(held, scan);
      }
    } catch (error) {
      if (request === this.request) {
        this.failure = error instanceof Error ? error.message : String(error);
      }
    }
  }

  /** Looks how much of the scan is on the screen. */
  follow(picture: Picture): void {
    if (this.previewShown !== null && picture.hasPicture) {
      this.firstPicture ??= performance.now();
      this.previewed = true;
      this.endPreview();
    }
    if (this.progress === null || this.held === null) {
      return;
    }
    this.progress = 0.9 + 0.1 * picture.uploaded;
    if (picture.hasPicture) {
      this.progress = null;
      this.previewed = false;
      this.wholePicture ??= performance.now();
      this.firstPicture ??= this.wholePicture;
    }
  }

  /** What waits for the coarse picture goes on. */
  endPreview(): void {
    this.previewShown?.();
    this.previewShown = null;
  }

  /**
   * Shows a large scan coarsely while all of it is on its way; what else the page does waits for that. Null where it
   * does not.
   */
  private async showCoarsely(scan: Scan, frame: ScanFrame, step: number, request: number): Promise<ScanVolume | null> {
    const coarse = previewStep(frame.dimensions, step);
    // what is not seen is not drawn
    if (coarse === null || document.hidden) {
      return null;
    }
    const { volume, bricks } = await downloadVolume(frame, coarse);
    if (request !== this.request || !this.outside.preview(volume, bricks, scan)) {
      return null;
    }
    await new Promise<void>((shown) => {
      this.previewShown = shown;
    });
    return volume;
  }

  /** A coarse scan becomes finer as the fine one arrives. */
  private refining(coarse: ScanVolume, request: number): Meanwhile {
    const show: Meanwhile["show"] = (volume, arrival) => {
      if (request === this.request) {
        this.outside.refine(volume, arrival);
      }
    };
    return { coarse, ...this.outside.shownParts, show };
  }

  private tellCoarseness(step: number): void {
    const resolution = `1/${String(step)} of its resolution`;
    this.coarseness = step === 1 ? null : `Too large for this GPU: shown at ${resolution}; touch uses all of it.`;
    if (this.coarseness !== null) {
      this.outside.warn(this.coarseness);
    }
  }
}
