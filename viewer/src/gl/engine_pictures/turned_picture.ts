/**
 * The last picture of the engine turned by its depth to the present view, until that is drawn.
 *
 * A view that turns by an angle moves what lies before its middle one way and what lies behind it the other way; the
 * drawn picture tells by its depth which is which. Turned pictures have few pixels, so that one takes a part of a frame
 * where the CPU draws.
 */
import * as THREE from "three";
import { depthOf, nearAndFar, pixelSizeAt } from "../../core/geometry/camera";
import { FullscreenPass } from "../base/fullscreen_pass";
import { PictureTarget } from "../base/picture_target";
import { ThreeCamera } from "../base/three_camera";
import { shaders } from "../shaders/shaders";
import type { DepthUniforms } from "./engine_pass";
import type { EngineView } from "./engine_pictures";

/** Of the resolution, at the finest: it is put together before it is enlarged. */
const finestDivisor = 3.2;
/** Pixels from step to step along a ray in the drawn picture. */
const stepPixels = 1.5;
const mostSteps = 64;
/** How steep surfaces may be that are followed from pixel to pixel: pixels of depth for each. */
const steepest = 8;

/** What is turned: a picture in a target, its view and how much wider than high, its least and largest depth [mm]. */
export interface TakenPicture {
  readonly target: PictureTarget;
  readonly view: EngineView;
  readonly aspect: number;
  readonly span: readonly [number, number];
}

export class TurnedPicture {
  readonly target: PictureTarget;
  /** The drawn picture has changed since it was turned last. */
  isStale = true;
  private readonly drawn = new ThreeCamera();
  private readonly now = new ThreeCamera();
  /** How deep what is seen lies in the drawn picture. */
  private readonly seen = new THREE.WebGLRenderTarget(1, 1, {
    format: THREE.RedFormat,
    type: THREE.HalfFloatType,
    minFilter: THREE.NearestFilter,
    magFilter: THREE.NearestFilter,
    depthBuffer: false,
  });
  private readonly drawnUniforms = {
    picture: { value: null as THREE.Texture | null },
    pictureDepth: { value: null as THREE.Texture | null },
    hazeDepth: { value: 0 },
    used: { value: new THREE.Vector2() },
    drawnNearFar: { value: new THREE.Vector2() },
    drawnParallel: { value: 0 },
  };
  private readonly uniforms = {
    ...this.drawnUniforms,
    seenDepth: { value: this.seen.texture },
    share: { value: new THREE.Vector2() },
    drawnReach: { value: new THREE.Vector2() },
    size: { value: new THREE.Vector2() },
    drawnFromTurned: { value: new THREE.Matrix4() },
    steps: { value: 1 },
    thickness: { value: 0 },
  };
  private readonly seenPass: FullscreenPass;
  private readonly pass = new FullscreenPass(shaders.turned, this.uniforms);

  constructor(halfFloat: boolean, depth: DepthUniforms) {
    this.target = new PictureTarget(halfFloat);
    this.seenPass = new FullscreenPass(shaders.seenDepth, { ...this.drawnUniforms, ...depth });
  }

  async prepare(renderer: THREE.WebGLRenderer): Promise<void> {
    await Promise.all([this.seenPass.prepare(renderer), this.pass.prepare(renderer)]);
  }

  /** Draws a picture of one view as it is seen in another. */
  draw(renderer: THREE.WebGLRenderer, picture: TakenPicture, to: EngineView): void {
    const { target } = this;
    const { width, height } = picture.target.target;
    target.resize(width, height);
    target.useLevel(Math.max(finestDivisor, width / picture.target.width));
    if (this.isStale) {
      this.take(renderer, picture);
      this.isStale = false;
    }
    const u = this.uniforms;
    this.now.update(to.camera, to.extent, picture.aspect);
    u.size.value.set(target.width, target.height);
    u.drawnFromTurned.value
      .multiplyMatrices(this.drawn.camera.projectionMatrix, this.drawn.camera.matrixWorldInverse)
      .multiply(this.now.camera.matrixWorld)
      .multiply(this.now.camera.projectionMatrixInverse);
    u.steps.value = this.stepsAcross();
    target.useRows(0, target.height);
    this.pass.draw(renderer, target.target);
  }

  dispose(): void {
    this.target.dispose();
    this.seen.dispose();
    this.seenPass.dispose();
    this.pass.dispose();
  }

  /** Takes up a picture, and how deep all that is seen in it lies. */
  private take(renderer: THREE.WebGLRenderer, { target: drawn, view, aspect, span }: TakenPicture): void {
    const { camera, extent } = view;
    const { target, width, height } = drawn;
    const u = this.uniforms;
    this.drawn.update(camera, extent, aspect);
    const { near, far } = nearAndFar(camera, extent);
    const deviceDepth = (depth: number): number => {
      const inside = Math.min(far, Math.max(near, depth));
      const share = (inside - near) / (far - near);
      return 2 * (camera.parallel === null ? (share * far) / inside : share) - 1;
    };
    const haze = depthOf(camera, extent.centre);
    u.picture.value = target.texture;
    u.pictureDepth.value = target.depthTexture;
    u.hazeDepth.value = 0.5 + 0.5 * deviceDepth(haze);
    u.share.value.set(width / target.width, height / target.height);
    u.used.value.set(width, height);
    u.drawnNearFar.value.set(near, far);
    u.drawnParallel.value = camera.parallel === null ? 0 : 1;
    u.thickness.value = steepest * pixelSizeAt(camera, extent.centre, { width, height: this.target.height });
    const margin = u.thickness.value;
    // over a slow line the span is that of the steps of depth, and larger than anything shown
    u.drawnReach.value.set(
      deviceDepth(Math.max(haze - extent.radius, Math.min(span[0], haze)) - margin),
      deviceDepth(Math.min(haze + extent.radius, Math.max(span[1], haze)) + margin),
    );
    this.seen.setSize(width, height);
    this.seenPass.draw(renderer, this.seen);
  }

  /** Steps of which none takes a ray farther than some pixels of this picture. */
  private stepsAcross(): number {
    const { width, height } = this.target;
    const { drawnFromTurned, drawnReach } = this.uniforms;
    const turnedFromDrawn = drawnFromTurned.value.clone().invert();
    const pixels = [-1, 0, 1].flatMap((x) => [-1, 0, 1].map((y) => {
      const [begin, end] = [drawnReach.value.x, drawnReach.value.y].map((z) =>
        new THREE.Vector3(x, y, z).applyMatrix4(turnedFromDrawn));
      return begin === undefined || end === undefined
        ? 0
        : Math.hypot(((end.x - begin.x) * width) / 2, ((end.y - begin.y) * height) / 2);
    }));
    return Math.min(mostSteps, Math.max(1, Math.ceil(Math.max(...pixels) / stepPixels)));
  }
}
