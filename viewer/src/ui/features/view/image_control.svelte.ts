/**
 * Pictures and films of the 3-D view as files: drawn anew at the size that is asked for, one at a time.
 */
import type { Camera, Viewport } from "../../../core/geometry/camera";
import { evenSize, fitsIntoCanvas, imageSize } from "../../../core/view/image_size";
import { turntable } from "../../../core/view/turntable";
import { keep } from "../../state/download";
import { AnimationRecorder, animationType } from "./animation";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";
import type { Stage } from "../../app/stage.svelte";

const firstChoice = { magnification: 2, transparent: false, seconds: 6, turns: 1 };

/** Of a film: each frame is drawn to the end, so a slow machine only takes longer. */
const framesPerSecond = { gpu: 20, software: 10 } as const;

export class ImageControl {
  choice = $state.raw(recall("image", firstChoice));
  /** What is being made, and the share that is done; null where nothing is. */
  job = $state.raw<{ readonly name: string; readonly share: number } | null>(null);
  private aborter = new AbortController();

  constructor(
    private readonly stage: Stage,
    private readonly session: Session,
  ) {}

  readonly size = $derived.by((): Viewport => this.sizeOf(this.choice.magnification));

  /** Whether this browser makes films. */
  readonly canAnimate = animationType() !== null;

  sizeOf(magnification: number): Viewport {
    const { slices, stereo } = this.stage;
    const size = imageSize(slices.panes.view, window.devicePixelRatio, magnification);
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
    await this.work("Drawing the picture", async (camera, signal) => {
      const context = contextOf(size);
      await this.stage.snapshot(context, { camera, size, stereo: this.stage.stereo.choice, transparent, signal, progress: this.tell.bind(this) });
      const blob = await new Promise<Blob | null>((resolve) => {
        context.canvas.toBlob(resolve, "image/png");
      });
      if (blob === null) {
        throw new Error(`${String(size.width)} × ${String(size.height)} pixels are too many for this browser; choose fewer`);
      }
      keep(blob, `${this.fileName}.png`);
    });
  }

  /** Saves a film of the view turning about the body's long axis, as large as on the page. */
  async saveAnimation(): Promise<void> {
    const { seconds, turns } = this.choice;
    const pace = framesPerSecond[this.stage.software ? "software" : "gpu"];
    const size = evenSize(this.sizeOf(1));
    const stereo = this.stage.stereo.choice;
    await this.work("Filming", async (start, signal) => {
      const film = new AnimationRecorder(size, pace);
      try {
        const context = contextOf(size);
        const cameras = turntable(start, { seconds, turns, framesPerSecond: pace });
        for (const [i, camera] of cameras.entries()) {
          await this.stage.snapshot(context, { camera, size, stereo, transparent: false, signal });
          await film.add(context.canvas);
          this.tell((i + 1) / cameras.length);
        }
        keep(await film.end(), `${this.fileName}.webm`);
      } finally {
        film.dispose();
      }
    });
  }

  private get fileName(): string {
    return (this.session.scan?.name ?? "").replace(/[^\w.-]+/g, "_") || "palpate";
  }

  private tell(share: number): void {
    this.job = this.job && { ...this.job, share };
  }

  /** Does a job from the present view; one that was cancelled leaves nothing. */
  private async work(name: string, act: (camera: Camera, signal: AbortSignal) => Promise<void>): Promise<void> {
    const { camera } = this.stage.view;
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
        this.session.notify("error", `Nothing was saved: ${error instanceof Error ? error.message : String(error)}`);
      }
    } finally {
      this.job = null;
    }
  }
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
