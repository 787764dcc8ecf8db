/**
 * Pictures of the view that the engine draws: asks for them as the view changes, and takes the newest that has come.
 *
 * While the camera moves one picture is asked for after another, in haste: the next one as soon as the one before has
 * come, in the newest view. Once the camera rests, or where anything else has changed, the engine goes on to finer ones
 * by itself. A picture is shown with the camera that it was asked with, so that picture and markers always fit.
 */
import { deepEqual } from "../../core/base/deep_equal";
import type { Camera, Extent } from "../../core/geometry/camera";
import type { DrawnPicture, DrawPicture, PictureFailed, PictureLook } from "../../core/protocol";
import type { RestingPicture } from "../../core/view/quality";
import { fewestSamples } from "../../core/view/saved_pictures";
import { eyeCamera } from "../../core/view/stereo";
import { rawTexels, unpackedTexels, type PictureTexels } from "./picture_texels";

/**
 * Rest before finer pictures are asked for [ms]: two to three frames and moves of a mouse. A view that moves again has
 * them given up at once.
 */
const settleMilliseconds = 50;
/** So long an answer may take [ms]. */
const patience = 10_000;

/** From where a picture is seen. */
export interface EngineView {
  readonly camera: Camera;
  readonly extent: Extent;
}

/** What is asked for: what eyes see that stand so far to the right [share of the distance], in pictures of one size. */
export interface EngineFrame {
  /** Columns and rows of one eye's picture. */
  readonly size: readonly [number, number];
  readonly asides: readonly number[];
}

/** A picture to be drawn, and how it is seen. */
export interface ArrivedPicture extends PictureTexels {
  readonly view: EngineView;
  /** That was asked for. */
  readonly frame: EngineFrame;
}

interface Wanted {
  readonly view: EngineView;
  readonly frame: EngineFrame;
  readonly moving: boolean;
}

interface Asked extends Wanted {
  readonly number: number;
  readonly askedAt: number;
  /** A picture in this view is on display already: what moves need not wait for a finer one. */
  readonly seen: boolean;
  readonly look: PictureLook;
  readonly fineness: Fineness;
}

/** How finely a picture at rest is drawn. */
type Fineness = Pick<DrawPicture, "steps_per_voxel" | "samples" | "jitter">;

/** All of a picture that is on display, and what of it was edited since. */
interface OnDisplay {
  readonly asked: Asked;
  /** Number of what it shows, which rises with every change of that. */
  readonly state: number;
  readonly divisor: number;
}

export class EnginePictures {
  resting: RestingPicture = { stepsPerVoxel: 1, passes: 1 };
  jitter = true;
  /** Pictures that have come since `recount`. */
  count = 0;
  /** The last picture that was asked for has come as fine as it gets. */
  finished = false;
  /** Why no pictures come; null where they do. */
  failure: string | null = null;
  /** Is told how long each picture took from its request until it came, while the view moved [ms]. */
  onAnswer: (milliseconds: number) => void = () => undefined;
  /** Number of the request whose picture came last; 0 before the first. */
  answered = 0;
  private look: PictureLook | null = null;
  private toldLook: PictureLook | null = null;
  private asked: readonly Asked[] = [];
  /** What is asked for as soon as the request before it is answered. */
  private wanted: Wanted | null = null;
  /** The last request of which nothing has come. */
  private unanswered: Asked | null = null;
  private arrived: (ArrivedPicture & { readonly asked: Asked }) | null = null;
  private onDisplay: OnDisplay | null = null;
  private number = 0;
  private received = 0;
  private shownReceived = 0;
  private lastView: EngineView | null = null;
  private lastSeen: Asked | null = null;
  private movedAt = -Infinity;
  /** The camera rests, but the engine does not know yet. */
  private moving = false;
  /** Number of the last request before something else than the view changed. */
  private changedAfter = 0;

  /** @param clock tells the time [ms]. */
  constructor(
    private readonly send: (message: DrawPicture | PictureLook) => void,
    private readonly clock: () => number = () => performance.now(),
  ) {}

  /** How pictures look that are asked for from now on. */
  setLook(look: PictureLook): void {
    // a list of segments is new with every edit, and looks the same most often
    if (!deepEqual(look, this.look)) {
      this.look = look;
    }
  }

  /** What was on display is not any more: parts of it would come over something else. */
  cover(): void {
    this.onDisplay = null;
  }

  /** Another engine, or the same after the connection was lost, knows nothing of this page. */
  forget(): void {
    this.toldLook = null;
    this.asked = [];
    this.arrived = null;
    this.wanted = null;
    this.unanswered = null;
    this.lastSeen = null;
    this.onDisplay = null;
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
   */
  ask(changed: boolean, view: EngineView, frame: EngineFrame): void {
    const now = this.clock();
    if (this.look === null) {
      return;
    }
    if (changed) {
      this.moving = this.lastView?.camera !== view.camera;
      if (!this.moving) {
        this.changedAfter = this.number;
      }
      this.movedAt = now;
      this.want({ view, frame, moving: this.moving });
    } else if (this.moving && now - this.movedAt >= settleMilliseconds) {
      this.moving = false;
      this.want({ view, frame, moving: false });
    }
    this.lastView = view;
    this.pump();
    this.watch();
  }

  /** Asks for one picture in haste, to learn whether and how soon one comes; nothing else is asked for meanwhile. */
  probe(view: EngineView, frame: EngineFrame): void {
    if (this.unanswered === null && this.look !== null) {
      this.want({ view, frame, moving: true });
      this.pump();
    }
  }

  /** Notes where an answer is due for too long. */
  watch(): void {
    if (this.unanswered !== null && this.clock() - this.unanswered.askedAt > patience) {
      this.fail(`the engine sent no picture for ${String(patience / 1000)} s`);
    }
  }

  /** A picture of a view that has moved since is on its way: what stands over the picture moves with it. */
  get isTurning(): boolean {
    return this.moving && this.unanswered !== null && this.lastSeen !== null;
  }

  /** What is on display differs from what is to be seen by the view alone. */
  get differsByView(): boolean {
    const { changedAfter, lastSeen, look } = this;
    return lastSeen !== null && lastSeen.look === look && lastSeen.number > changedAfter;
  }

  /** Takes a picture that has come, or word that it does not. */
  take(answer: DrawnPicture | PictureFailed): void {
    if (answer.type === "picture_failed") {
      this.fail(answer.text);
      return;
    }
    this.received += 1;
    const received = this.received;
    if (answer.coding === "raw") {
      this.arrive(rawTexels(answer), received);
      return;
    }
    unpackedTexels(answer).then(
      (texels) => { this.arrive(texels, received); },
      () => { this.fail("a picture of the engine could not be unpacked"); },
    );
  }

  /** The newest picture that has come, or the part of it to be put over what is on display; null where none has. */
  next(frame: EngineFrame): ArrivedPicture | null {
    const { arrived } = this;
    this.arrived = null;
    if (arrived === null || !this.display(arrived.picture, arrived.asked)) {
      return null;
    }
    const { picture } = arrived;
    this.count += 1;
    this.answered = picture.number;
    this.finished = picture.finished && picture.number === this.number && this.wanted === null &&
      deepEqual(arrived.frame, frame);
    return arrived;
  }

  /** Notes what is on display from now on; false for a part of something else. */
  private display({ part, over, state, divisor }: DrawnPicture, asked: Asked): boolean {
    if (part !== null) {
      const { onDisplay } = this;
      const fits = onDisplay !== null && looksAs(onDisplay.asked, asked) && onDisplay.divisor === divisor &&
        over !== null && over <= onDisplay.state;
      if (!fits) {
        return false;
      }
    }
    this.onDisplay = { asked, state, divisor };
    return true;
  }

  /** Keeps a picture to be drawn, if it is newer than what came before, and asks for the next. */
  private arrive(texels: PictureTexels, received: number): void {
    const { number } = texels.picture;
    const asked = this.asked.find((one) => one.number === number);
    if (asked === undefined || received < this.shownReceived) {
      return;
    }
    this.shownReceived = received;
    this.asked = this.asked.filter((one) => one.number >= number);
    this.arrived = { ...texels, view: asked.view, frame: asked.frame, asked };
    this.lastSeen = asked;
    this.failure = null;
    if (this.unanswered?.number === number) {
      this.unanswered = null;
      if (asked.moving) {
        this.onAnswer(this.clock() - asked.askedAt);
      }
    }
    this.pump();
  }

  private want(wanted: Wanted): void {
    this.wanted = wanted;
    this.finished = false;
  }

  /** Asks for what is wanted, unless an answer is due. */
  private pump(): void {
    const { unanswered, wanted } = this;
    if (wanted === null || (unanswered !== null && !unanswered.seen)) {
      return;
    }
    this.wanted = null;
    this.request(wanted);
  }

  private request(wanted: Wanted): void {
    const { look, onDisplay } = this;
    if (look === null) {
      return;
    }
    const isNewLook = look !== this.toldLook;
    if (isNewLook) {
      this.send(look);
      this.toldLook = look;
    }
    const { view, frame, moving } = wanted;
    const seen = !moving && !isNewLook && this.lastSeen?.view.camera === view.camera && this.lastSeen.moving;
    this.number += 1;
    const fineness = {
      steps_per_voxel: this.resting.stepsPerVoxel,
      samples: this.jitter ? Math.max(fewestSamples, this.resting.passes) : 1,
      jitter: this.jitter,
    };
    const asked = { ...wanted, number: this.number, askedAt: this.clock(), seen, look, fineness };
    const isShown = !moving && onDisplay !== null && looksAs(onDisplay.asked, asked);
    this.asked = [...this.asked, asked];
    this.unanswered = asked;
    this.send({
      type: "draw_picture",
      number: this.number,
      cameras: frame.asides.map((aside) => seenFrom(eyeCamera(view.camera, aside))),
      size: frame.size,
      moving,
      over: isShown ? { state: onDisplay.state, divisor: onDisplay.divisor } : null,
      ...fineness,
    });
  }

  private fail(reason: string): void {
    this.failure = reason;
    this.forget();
  }
}

/** Whether two pictures differ by edits alone. */
function looksAs(one: Asked, other: Asked): boolean {
  return one.view.camera === other.view.camera && deepEqual(one.frame, other.frame) &&
    deepEqual(one.fineness, other.fineness) &&
    (one.look === other.look || deepEqual(withoutEdited(one.look), withoutEdited(other.look)));
}

/** That a segment is edited changes nothing beside the edits. */
function withoutEdited(look: PictureLook): PictureLook {
  return { ...look, segments: look.segments.map((segment) => ({ ...segment, edited: false })) };
}

export function seenFrom(camera: Camera): DrawPicture["cameras"][number] {
  const { target, distance, right, up, back, field, parallel, aside = 0 } = camera;
  return { target, distance, right, up, back, field, parallel, aside };
}
