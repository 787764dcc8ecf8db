/**
 * Images and animations of the 3-D view as files: drawn anew at the size that is asked for, one at a time.
 */
import type { Camera, Viewport } from "../../../core/geometry/camera";
import { evenSize, fitsIntoCanvas, imageSize } from "../../../core/view/image_size";
import { turntable } from "../../../core/view/turntable";
import type { SnapshotWish } from "../../../gl/picture/snapshot";
import { saveFile } from "../../state/download";
import { AnimationRecorder, animationType } from "./animation";
import { overlayOf } from "./overlay_text";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";
import type { StereoControl } from "./stereo_control.svelte";
import type { ViewControl } from "./view_control.svelte";

const firstChoice = { magnification: 2, transparent: false, marks: true, seconds: 6, turns: 1 };

/** Lengths of an animation that are offered [s]. */
export const filmSeconds = { least: 2, most: 30 } as const;

/** Of an animation: each frame is drawn to the end, so a slow machine only takes longer. */
const framesPerSecond = { gpu: 20, software: 10 } as const;

/** What images are drawn from. */
interface Source {
  readonly session: Session;
  readonly view: ViewControl;
  readonly stereo: StereoControl;
  /** Size of the 3-D view on the page [CSS pixels]. */
  readonly pane: () => Viewport;
  readonly picture: {
    readonly support: { readonly software: boolean };
    readonly snapshot: (context: CanvasRenderingContext2D, wish: SnapshotWish) => Promise<void>;
    readonly film: (
      context: CanvasRenderingContext2D,
      cameras: readonly Camera[],
      wish: Omit<SnapshotWish, "camera">,
      taken: (view: number) => Promise<void>,
    ) => Promise<void>;
  };
}

export class ImageControl {
  choice = $state.raw(sane(recall("image", firstChoice)));
  /** What is being made, and the share that is done; null where nothing is. */
  job = $state.raw<{ readonly name: string; readonly share: number } | null>(null);
  /** What of the page holds all that is written over the view. */
  view: Element | null = null;
  private aborter = new AbortController();

  constructor(private readonly source: Source) {}

  readonly size = $derived.by((): Viewport => this.sizeOf(this.choice.magnification));

  /** Whether this browser records animations. */
  readonly canAnimate = animationType() !== null;

  sizeOf(magnification: number): Viewport {
    const { pane, stereo } = this.source;
    const size = imageSize(pane(), window.devicePixelRatio, magnification);
    return stereo.choice.mode === "off" ? size : evenSize(size);
  }

  fits(magnification: number): boolean {
    return fitsIntoCanvas(this.sizeOf(magnification));
  }

  choose(part: Partial<typeof firstChoice>): void {
    this.choice = { ...this.choice, ...part };
    remember("image", this.choice);
  }

  cancel(): void {
    this.aborter.abort();
  }

  /** Saves the view as a PNG of the chosen size. */
  async saveImage(): Promise<void> {
    const { size } = this;
    const { transparent } = this.choice;
    const marks = this.choice.marks && this.source.stereo.choice.mode === "off";
    const overlay = marks && this.view !== null ? overlayOf(this.view) : null;
    await this.work("Drawing the picture", async (camera, signal) => {
      const context = contextOf(size);
      const stereo = this.source.stereo.choice;
      const progress = this.report.bind(this);
      await this.source.picture.snapshot(context, { camera, size, stereo, transparent, marks, signal, progress });
      overlay?.(context);
      const blob = await new Promise<Blob | null>((resolve) => {
        context.canvas.toBlob(resolve, "image/png");
      });
      if (blob === null) {
        throw new Error(
          `${String(size.width)} × ${String(size.height)} pixels are too many for this browser; choose fewer`,
        );
      }
      this.keep(blob, "png");
    });
  }

  /** Saves a turntable: the view turning about the body's long axis, as large as on the page. */
  async saveAnimation(): Promise<void> {
    const { seconds, turns } = this.choice;
    const pace = framesPerSecond[this.source.picture.support.software ? "software" : "gpu"];
    const size = evenSize(this.sizeOf(1));
    const stereo = this.source.stereo.choice;
    await this.work("Filming", async (start, signal) => {
      const animation = new AnimationRecorder(size, pace);
      try {
        const context = contextOf(size);
        const cameras = turntable(start, { seconds, turns, framesPerSecond: pace });
        await this.source.picture.film(context, cameras, { size, stereo, transparent: false, signal }, async (i) => {
          await animation.add(context.canvas);
          this.report((i + 1) / cameras.length);
        });
        this.keep(await animation.end(), "webm");
      } finally {
        animation.dispose();
      }
    });
  }

  private keep(content: Blob, ending: "png" | "webm"): void {
    const { session } = this.source;
    const name = `${(session.scan?.name ?? "").replace(/[^\w.-]+/g, "_") || "palpate"}.${ending}`;
    saveFile(session, content, name);
  }

  private report(share: number): void {
    this.job = this.job && { ...this.job, share };
  }

  /** Does a job from the present view; one that was cancelled leaves nothing. */
  private async work(name: string, act: (camera: Camera, signal: AbortSignal) => Promise<void>): Promise<void> {
    const { camera } = this.source.view;
    if (this.job !== null || camera === null) {
      return;
    }
    this.aborter = new AbortController();
    const { signal } = this.aborter;
    this.job = { name, share: 0 };
    try {
      await act(camera, signal);
    } catch (error) {
      if (!signal.aborted) {
        this.source.session.notify(
          "error",
          `Nothing was saved: ${error instanceof Error ? error.message : String(error)}`,
        );
      }
    } finally {
      this.job = null;
    }
  }
}

/** What was chosen at a visit when a film could be shorter. */
function sane(choice: typeof firstChoice): typeof firstChoice {
  return { ...choice, seconds: Math.max(filmSeconds.least, choice.seconds) };
}

function contextOf({ width, height }: Viewport): CanvasRenderingContext2D {
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width, height });
  const context = canvas.getContext("2d");
  if (context === null) {
    throw new Error("the browser gives no canvas of this size");
  }
  return context;
}
