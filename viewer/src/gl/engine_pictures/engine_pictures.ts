/**
 * Pictures of the view that the engine draws: asks for them as the view changes, and takes the newest that has come.
 *
 * While the camera moves one picture is asked for at a time of each frame, in haste; once it rests, or where anything
 * else has changed, the engine goes on to finer ones by itself. A picture is shown with the camera that it was asked
 * with, so that picture and markers always fit.
 */
import type { Camera, Extent } from "../../core/geometry/camera";
import type { DrawnPicture, DrawPicture, PictureLook } from "../../core/protocol";
import type { RestingPicture } from "../../core/view/quality";
import { fewestSamples } from "../../core/view/saved_pictures";

/** Rest before finer pictures are asked for [ms]. */
const settleMilliseconds = 90;

/** From where a picture is seen. */
export interface EngineView {
  readonly camera: Camera;
  readonly extent: Extent;
}

/** A picture to be drawn, and how it is seen. */
export interface ArrivedPicture {
  readonly picture: DrawnPicture;
  readonly view: EngineView;
}

interface Asked {
  readonly number: number;
  readonly view: EngineView;
  readonly size: readonly [number, number];
}

export class EnginePictures {
  resting: RestingPicture = { stepsPerVoxel: 1, passes: 1 };
  jitter = true;
  /** Pictures that have come since `recount`. */
  count = 0;
  /** The last picture that was asked for has come as fine as it gets. */
  finished = false;
  /** Number of the request whose picture came last; 0 before the first. */
  answered = 0;
  private look: PictureLook | null = null;
  private toldLook: PictureLook | null = null;
  private asked: readonly Asked[] = [];
  private arrived: DrawnPicture | null = null;
  private number = 0;
  private movedAt = -Infinity;
  /** The camera rests, but the engine does not know yet. */
  private moving = false;

  constructor(private readonly send: (message: DrawPicture | PictureLook) => void) {}

  /** How pictures look that are asked for from now on. */
  setLook(look: PictureLook): void {
    this.look = look;
  }

  /** Another engine, or the same after the connection was lost, knows nothing of this page. */
  forget(): void {
    this.toldLook = null;
    this.asked = [];
    this.arrived = null;
  }

  /** Number of the last request; 0 before the first. */
  get requested(): number {
    return this.number;
  }

  recount(): void {
    this.count = 0;
  }

  /**
   * Asks for what is due.
   *
   * @param changed the view or what is seen has changed since the last call.
   * @param size of the picture [pixels].
   * @param now [ms].
   */
  ask(changed: boolean, view: EngineView, size: readonly [number, number], now: number): void {
    if (this.look === null) {
      return;
    }
    if (changed) {
      const before = this.asked.at(-1)?.view.camera;
      this.moving = before !== view.camera;
      this.movedAt = now;
      this.request(view, size, this.moving);
    } else if (this.moving && now - this.movedAt >= settleMilliseconds) {
      this.moving = false;
      this.request(view, size, false);
    }
  }

  /** A picture of a view that has moved since is on its way: what stands over the picture moves with it. */
  get isTurning(): boolean {
    return this.moving && this.asked.length > 1;
  }

  /** Takes a picture that has come; one that was asked for earlier than one on display is none any more. */
  take(picture: DrawnPicture): void {
    this.arrived = picture;
  }

  /** The newest picture that has come and fits the size; null where none has. */
  next(size: readonly [number, number]): ArrivedPicture | null {
    const picture = this.arrived;
    this.arrived = null;
    const asked = this.asked.find(({ number }) => number === picture?.number);
    if (picture === null || asked === undefined) {
      return null;
    }
    this.asked = this.asked.filter(({ number }) => number >= asked.number);
    if (asked.size[0] !== size[0] || asked.size[1] !== size[1]) {
      return null;
    }
    this.count += 1;
    this.answered = picture.number;
    this.finished = picture.finished && picture.number === this.number;
    return { picture, view: asked.view };
  }

  private request(view: EngineView, size: readonly [number, number], moving: boolean): void {
    if (this.look !== null && this.look !== this.toldLook) {
      this.send(this.look);
      this.toldLook = this.look;
    }
    this.number += 1;
    this.finished = false;
    this.asked = [...this.asked, { number: this.number, view, size }];
    this.send({
      type: "draw_picture",
      number: this.number,
      camera: seenFrom(view.camera),
      size,
      moving,
      steps_per_voxel: this.resting.stepsPerVoxel,
      samples: this.jitter ? Math.max(fewestSamples, this.resting.passes) : 1,
      jitter: this.jitter,
    });
  }
}

export function seenFrom({ target, distance, right, up, back, field, parallel, aside = 0 }: Camera): DrawPicture["camera"] {
  return { target, distance, right, up, back, field, parallel, aside };
}
