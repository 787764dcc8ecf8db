/**
 * An animation in WebM from single pictures. The recorder counts time only while it runs: it runs for the
 * length of one frame after each picture and rests while the next one is drawn, however long that takes.
 */
import type { Viewport } from "../../../core/geometry/camera";

const types = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"] as const;
/** Bits for each pixel of a frame, at most: with fewer the first frames are blocky, since codecs begin carefully. */
const bitsPerPixel = 3;

/** What this browser records; null where it makes no WebM. */
export function animationType(): string | null {
  return typeof MediaRecorder === "undefined"
    ? null
    : (types.find((type) => MediaRecorder.isTypeSupported(type)) ?? null);
}

export class AnimationRecorder {
  private readonly context: CanvasRenderingContext2D;
  private readonly stream: MediaStream;
  private readonly recorder: MediaRecorder;
  private readonly pieces: Blob[] = [];

  /** @throws where the browser records no video. */
  constructor(
    { width, height }: Viewport,
    private readonly framesPerSecond: number,
  ) {
    const type = animationType();
    const canvas = document.createElement("canvas");
    Object.assign(canvas, { width, height });
    const context = canvas.getContext("2d");
    if (type === null || context === null) {
      throw new Error("this browser records no WebM films");
    }
    this.context = context;
    // frames are taken when they are asked for
    this.stream = canvas.captureStream(0);
    this.recorder = new MediaRecorder(this.stream, {
      mimeType: type,
      videoBitsPerSecond: Math.round(width * height * framesPerSecond * bitsPerPixel),
    });
    this.recorder.addEventListener("dataavailable", ({ data }) => {
      this.pieces.push(data);
    });
    this.recorder.start();
    this.recorder.pause();
  }

  /** Adds a frame. */
  async add(picture: HTMLCanvasElement): Promise<void> {
    this.recorder.resume();
    frameSource(this.stream)?.requestFrame();
    this.context.drawImage(picture, 0, 0);
    await new Promise((resolve) => setTimeout(resolve, 1000 / this.framesPerSecond));
    this.recorder.pause();
  }

  /** The whole animation. */
  async end(): Promise<Blob> {
    await new Promise((resolve) => {
      this.recorder.addEventListener("stop", resolve, { once: true });
      this.recorder.stop();
    });
    const video = new Blob(this.pieces, { type: "video/webm" });
    if (video.size === 0) {
      throw new Error("the browser recorded nothing");
    }
    return video;
  }

  dispose(): void {
    if (this.recorder.state !== "inactive") {
      this.recorder.stop();
    }
    for (const track of this.stream.getTracks()) {
      track.stop();
    }
  }
}

/** What is asked for frames: the track, in Firefox the stream. */
function frameSource(stream: MediaStream): { requestFrame(): void } | undefined {
  const [track] = stream.getVideoTracks();
  return [track, stream].find(
    (each): each is CanvasCaptureMediaStreamTrack => each !== undefined && "requestFrame" in each,
  );
}
