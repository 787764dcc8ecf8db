/**
 * Draws the 3-D view with pictures of the engine instead of the ray caster: into the same cached picture with its
 * depth, so that all that stands over it goes on as it is. Between them the last one is turned to the present view.
 */
import type * as THREE from "three";
import type { Appearance } from "../../core/appearance/appearance";
import { hasDepth } from "../../core/appearance/optics";
import { engineLook, type LookedSegments } from "../../core/drawing/engine_look";
import type { Camera } from "../../core/geometry/camera";
import type { DrawnPicture, DrawPicture, PictureFailed, PictureLook } from "../../core/protocol";
import type { SecondAppearance } from "../../core/second/second_scan";
import type { Plane } from "../../core/view/clip";
import { everywhere, type Region } from "../../core/view/region";
import { eyeCamera } from "../../core/view/stereo";
import { turnedView } from "../../core/view/turned_view";
import { deepEqual } from "../../core/base/deep_equal";
import type { PictureTarget } from "../base/picture_target";
import type { RayMarcher } from "../march/ray_marcher";
import { EnginePass } from "./engine_pass";
import { EnginePictures, type ArrivedPicture, type EngineFrame, type EngineView } from "./engine_pictures";
import { TurnedPicture } from "./turned_picture";

/**
 * Between two pictures of the engine, turned ones have no more than one part of so many of the time: where one CPU
 * draws all, the engine's pictures would come later for them. A picture that has just come is turned at once.
 */
const partsOfTime = 4;

/** What pictures are drawn into. */
interface Screen {
  readonly frame: EngineFrame;
  /** The cached picture of each eye; of a squeezed one narrower, or lower, than in the frame. */
  readonly targets: readonly PictureTarget[];
}

export class EngineDrawing {
  readonly pictures: EnginePictures;
  /** With what the picture on display was drawn. */
  shown = { divisor: 0, stepsPerVoxel: 0, passes: 0, triangles: 0 };
  private readonly pass: EnginePass;
  /** Of parts, so that the picture before is still there where the target gets another size. */
  private readonly partPass: EnginePass;
  private appearance: Appearance | null = null;
  private segments: LookedSegments = { segments: [], modes: {} };
  private clip: readonly Plane[] = [];
  private second: SecondAppearance | null = null;
  /** The picture on display, and for what it was drawn into its targets. */
  private last: ArrivedPicture | null = null;
  private drawnFrame: EngineFrame | null = null;
  /** The least and the largest depth of what it shows [mm]. */
  private span: readonly [number, number] = [0, 0];
  /** Of each eye. */
  private readonly turned: readonly [TurnedPicture, TurnedPicture];
  /** What is on display is the last picture, turned. */
  private isTurned = false;
  /** The camera that it was turned toward last. */
  private turnedFor: Camera | null = null;
  /** When the screen was drawn last, and how long it took from there to the next frame [ms]. */
  private drawnAt = -Infinity;
  private took = 0;
  private awaitsFrame = false;
  /** Turned pictures that showed the present view. */
  turns = 0;
  /** Off: between two pictures more than the view changes, so that the last one is not turned. */
  mayTurn = true;

  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    marcher: RayMarcher,
    halfFloat: boolean,
    send: (message: DrawPicture | PictureLook) => void,
  ) {
    this.pass = new EnginePass(marcher);
    this.partPass = new EnginePass(marcher);
    const turned = (): TurnedPicture => new TurnedPicture(halfFloat, this.pass.depthUniforms);
    this.turned = [turned(), turned()];
    this.pictures = new EnginePictures(send);
  }

  async prepare(): Promise<void> {
    await Promise.all([this.pass, this.partPass, ...this.turned].map((each) => each.prepare(this.renderer)));
  }

  /** What stands on the screen in place of an eye's cached picture; null where that does. */
  standIn(eye: number): PictureTarget | null {
    return this.isTurned ? this.turnedOf(eye).target : null;
  }

  setAppearance(appearance: Appearance): void {
    this.appearance = appearance;
    this.tell();
  }

  setSegments(segments: LookedSegments): void {
    this.segments = segments;
    this.tell();
  }

  setClip(clip: readonly Plane[]): void {
    this.clip = clip;
    this.tell();
  }

  setSecond(second: SecondAppearance | null): void {
    this.second = second;
    this.tell();
  }

  /** How pictures look now; null before there is anything to see. */
  get look(): PictureLook | null {
    return this.appearance && engineLook(this.appearance, this.segments, this.clip, this.second);
  }

  take(answer: DrawnPicture | PictureFailed): void {
    this.pictures.take(answer);
  }

  /** Another drew meanwhile: no picture of the engine is on display. */
  leave(): void {
    this.last = null;
    this.isTurned = false;
    this.pictures.cover();
  }

  /**
   * Asks for what is due, and draws what has come; returns where what is on display has changed, null where nowhere. In
   * a target of another size the last picture stands in until one of that size has come.
   *
   * @param changed the view or what is seen has changed since the last call.
   * @param view as seen from between the eyes.
   * @param aim turns the cached picture that is drawn into to what an eye sees.
   * @param look turns what stands over the pictures on display to a view.
   */
  advance({ changed, view, screen, aim, look }: {
    readonly changed: boolean;
    readonly view: EngineView;
    readonly screen: Screen;
    readonly aim: (view: EngineView) => void;
    readonly look: (view: EngineView) => void;
  }): Region | null {
    const now = performance.now();
    this.took = this.awaitsFrame ? now - this.drawnAt : this.took;
    const drawn = this.bring(changed, view, screen, aim);
    if (drawn === everywhere && this.last !== null) {
      look(this.last.view);
    }
    const isTurned = this.turn(drawn, view, screen, look, now);
    this.awaitsFrame = isTurned || drawn !== null;
    this.drawnAt = this.awaitsFrame ? now : this.drawnAt;
    return isTurned ? everywhere : drawn;
  }

  dispose(): void {
    this.pass.dispose();
    this.partPass.dispose();
    this.turned.forEach((each) => { each.dispose(); });
  }

  private turnedOf(eye: number): TurnedPicture {
    return this.turned[eye === 0 ? 0 : 1];
  }

  /** Shows the last picture as the present view is, or as it was drawn; true where that is another than before. */
  private turn(
    drawn: Region | null,
    view: EngineView,
    { frame, targets }: Screen,
    look: (view: EngineView) => void,
    now: number,
  ): boolean {
    this.turned.forEach((each) => { each.isStale ||= drawn !== null; });
    const { last } = this;
    const isDue = now - this.drawnAt >= partsOfTime * this.took;
    if (last === null || (drawn === null && (view.camera === this.turnedFor || !isDue))) {
      return false;
    }
    this.turnedFor = view.camera;
    const camera = this.turnedCamera(last, view.camera);
    if (camera !== null && camera !== last.view.camera) {
      const nearby = { ...view, camera };
      const aspect = frame.size[0] / frame.size[1];
      targets.forEach((target, eye) => {
        const [from, to] = [seenBy(eye, last, last.view), seenBy(eye, last, nearby)];
        this.pass.turn(eye);
        this.turnedOf(eye).draw(this.renderer, { target, view: from, aspect, span: this.span }, to);
      });
      this.turns += camera === view.camera ? 1 : 0;
      this.isTurned = true;
      look(nearby);
      return true;
    }
    if (this.isTurned && (drawn !== null || camera !== null)) {
      this.isTurned = false;
      look(last.view);
      return true;
    }
    // a turned one stays until a picture has come
    return false;
  }

  /** Asks for what is due, and draws what has come into the cached picture; returns where that has changed. */
  private bring(
    changed: boolean,
    view: EngineView,
    screen: Screen,
    aim: (view: EngineView) => void,
  ): Region | null {
    const { frame, targets: [target] } = screen;
    this.pictures.ask(changed, view, frame);
    const isResized = !deepEqual(this.drawnFrame, frame);
    if (isResized) {
      this.pictures.cover();
    }
    const next = this.pictures.next(frame);
    if (next?.picture.part && target !== undefined) {
      this.widen(next.picture);
      return this.drawPart(next, next.picture.part, target);
    }
    if (next !== null) {
      this.pass.take(next);
      this.last = next;
      this.span = [next.picture.nearest, next.picture.farthest];
    }
    if (this.last === null || (next === null && !isResized)) {
      return null;
    }
    this.drawnFrame = frame;
    this.draw(this.last, screen, aim);
    return everywhere;
  }

  /** To what the last picture can be turned; null where it would show what is not. */
  private turnedCamera({ view }: ArrivedPicture, now: Camera): Camera | null {
    const { appearance, mayTurn, pictures } = this;
    const isDeep = appearance !== null && hasDepth(appearance.optics);
    return mayTurn && pictures.differsByView ? turnedView(view.camera, now, isDeep) : null;
  }

  private draw(last: ArrivedPicture, { frame, targets }: Screen, aim: (view: EngineView) => void): void {
    const { divisor, samples } = last.picture;
    const { stepsPerVoxel } = this.pictures.resting;
    // the height of a view is the same in all sizes
    const wider = (frame.size[0] * last.frame.size[1]) / (frame.size[1] * last.frame.size[0]);
    targets.forEach((target, eye) => {
      target.useLevel(divisor);
      aim(seenBy(eye, last, last.view));
      this.pass.turn(eye);
      this.pass.draw(this.renderer, target, wider);
    });
    this.shown = { divisor, stepsPerVoxel, passes: samples, triangles: 0 };
  }

  private widen({ nearest, farthest }: DrawnPicture): void {
    this.span = [Math.min(this.span[0], nearest), Math.max(this.span[1], farthest)];
  }

  /** Draws what was edited over the rest of the picture on display, which is of the same view. */
  private drawPart(part: ArrivedPicture, first: readonly [number, number], target: PictureTarget): Region {
    this.partPass.take(part);
    target.useLevel(part.picture.divisor);
    this.partPass.drawPart(this.renderer, target, first);
    const { width, height } = target;
    const [columns, rows] = part.picture.size;
    // pixels beside it are mixed with its own where it is enlarged
    return [
      (first[0] - 1) / width,
      1 - (first[1] + rows + 1) / height,
      (first[0] + columns + 1) / width,
      1 - (first[1] - 1) / height,
    ];
  }

  private tell(): void {
    const { look } = this;
    if (look !== null) {
      this.pictures.setLook(look);
    }
  }
}

/** A view as an eye sees it by whom a picture was asked for; of more eyes the last one's. */
function seenBy(eye: number, { frame: { asides } }: ArrivedPicture, view: EngineView): EngineView {
  return { ...view, camera: eyeCamera(view.camera, asides[Math.min(eye, asides.length - 1)] ?? 0) };
}
