/**
 * Draws the 3-D view with pictures of the engine instead of the ray caster: into the same cached picture with its
 * depth, so that all that stands over it goes on as it is.
 */
import type * as THREE from "three";
import type { Appearance } from "../../core/appearance/appearance";
import { engineLook, type LookedSegments } from "../../core/drawing/engine_look";
import type { DrawnPicture, DrawPicture, PictureFailed, PictureLook } from "../../core/protocol";
import type { SecondAppearance } from "../../core/second/second_scan";
import type { Plane } from "../../core/view/clip";
import { everywhere, type Region } from "../../core/view/region";
import type { PictureTarget } from "../base/picture_target";
import type { RayMarcher } from "../march/ray_marcher";
import { EnginePass } from "./engine_pass";
import { EnginePictures, type ArrivedPicture, type EngineView } from "./engine_pictures";

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
  /** The picture on display, and the size of the target that it was drawn into. */
  private last: ArrivedPicture | null = null;
  private drawnSize: readonly [number, number] = [0, 0];

  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    marcher: RayMarcher,
    send: (message: DrawPicture | PictureLook) => void,
  ) {
    this.pass = new EnginePass(marcher);
    this.partPass = new EnginePass(marcher);
    this.pictures = new EnginePictures(send);
  }

  async prepare(): Promise<void> {
    await Promise.all([this.pass.prepare(this.renderer), this.partPass.prepare(this.renderer)]);
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
    this.pictures.cover();
  }

  /**
   * Asks for what is due, and draws what has come; returns where the cached picture has changed, null where nowhere. In
   * a target of another size the last picture stands in until one of that size has come.
   *
   * @param changed the view or what is seen has changed since the last call.
   * @param aim turns markers to a view.
   */
  advance({ changed, view, target, aim }: {
    readonly changed: boolean;
    readonly view: EngineView;
    readonly target: PictureTarget;
    readonly aim: (view: EngineView) => void;
  }): Region | null {
    const size = [target.target.width, target.target.height] as const;
    this.pictures.ask(changed, view, size);
    const isResized = this.drawnSize[0] !== size[0] || this.drawnSize[1] !== size[1];
    if (isResized) {
      this.pictures.cover();
    }
    const next = this.pictures.next(size);
    if (next?.picture.part) {
      return this.drawPart(next, next.picture.part, target);
    }
    if (next !== null) {
      this.pass.take(next);
      this.last = next;
    }
    if (this.last === null || (next === null && !isResized)) {
      return null;
    }
    this.drawnSize = size;
    this.draw(this.last, target, aim);
    return everywhere;
  }

  dispose(): void {
    this.pass.dispose();
    this.partPass.dispose();
  }

  private draw(last: ArrivedPicture, target: PictureTarget, aim: (view: EngineView) => void): void {
    const { divisor, samples } = last.picture;
    const { stepsPerVoxel } = this.pictures.resting;
    target.useLevel(divisor);
    aim(last.view);
    this.pass.draw(this.renderer, target, last.size);
    this.shown = { divisor, stepsPerVoxel, passes: samples, triangles: 0 };
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
