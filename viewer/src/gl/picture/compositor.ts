/**
 * Puts the cached picture with its depth into its pane of the screen, over the background.
 */
import * as THREE from "three";
import { looks } from "../../core/appearance/looks";
import { linearFromHex } from "../../core/base/colour";
import { Upscaler, type ScreenPane } from "./upscaler";
import { FullscreenPass } from "../base/fullscreen_pass";
import type { PictureTarget } from "../base/picture_target";
import { shaders } from "../shaders/shaders";

/** Pictures that are so many times as coarse as their pane are put together before they are enlarged. */
const coarse = 4;

const centre = linearFromHex(looks.ground.centre);
const rim = linearFromHex(looks.ground.edge);

export interface Composition {
  /** The renderer's viewport; of the screen, a picture that is not coarse fills it pixel by pixel. */
  readonly pane: ScreenPane;
  /** The screen where none is given. */
  readonly into?: THREE.WebGLRenderTarget;
  /** Without the background: colours that are not multiplied by opacity. */
  readonly transparent?: boolean;
}

export class Compositor {
  private readonly uniforms = {
    picture: { value: null as THREE.Texture | null },
    pictureDepth: { value: null as THREE.Texture | null },
    share: { value: new THREE.Vector2(1, 1) },
    used: { value: new THREE.Vector2(1, 1) },
    paneCorner: { value: new THREE.Vector2() },
    paneSize: { value: new THREE.Vector2(1, 1) },
    groundCorner: { value: new THREE.Vector2() },
    groundSize: { value: new THREE.Vector2(1, 1) },
    transparent: { value: 0 },
    bend: { value: 1 },
    backgroundCentre: { value: new THREE.Vector3(...centre) },
    backgroundEdge: { value: new THREE.Vector3(...rim) },
  };
  private readonly pass = new FullscreenPass(shaders.composite, this.uniforms);
  private readonly enlarger = new Upscaler();

  /** Whether highlights are bent instead of clipped; grey by window and level is shown as it is. */
  set bendsHighlights(on: boolean) {
    this.uniforms.bend.value = on ? 1 : 0;
  }

  get bendsHighlights(): boolean {
    return this.uniforms.bend.value > 0;
  }

  async prepare(renderer: THREE.WebGLRenderer): Promise<void> {
    await Promise.all([this.pass.prepare(renderer), this.enlarger.prepare(renderer)]);
  }

  /** Whether a picture is put together before it is enlarged, its background with it. */
  static isCoarse({ target, width }: PictureTarget): boolean {
    return target.width > (coarse - 1) * width;
  }

  draw(renderer: THREE.WebGLRenderer, source: PictureTarget, composition: Composition): void {
    const { width, height } = source;
    if (composition.into === undefined && Compositor.isCoarse(source)) {
      const { small } = this.enlarger;
      small.setSize(width, height);
      this.compose(renderer, source, { ...composition, pane: { corner: [0, 0], size: [width, height] }, into: small });
      this.enlarger.draw(renderer, source, composition.pane);
    } else {
      this.compose(renderer, source, composition);
    }
  }

  dispose(): void {
    this.pass.dispose();
    this.enlarger.dispose();
  }

  private compose(
    renderer: THREE.WebGLRenderer,
    source: PictureTarget,
    { pane: { corner, size }, into, transparent = false }: Composition,
  ): void {
    const u = this.uniforms;
    const { target, width, height } = source;
    u.picture.value = target.texture;
    u.pictureDepth.value = target.depthTexture;
    u.share.value.set(width / target.width, height / target.height);
    u.used.value.set(width, height);
    u.paneCorner.value.set(...corner);
    u.paneSize.value.set(...size);
    const whole = source.tile ?? { width: size[0], height: size[1], x: 0, y: 0 };
    u.groundCorner.value.set(corner[0] - whole.x, corner[1] - whole.y);
    u.groundSize.value.set(whole.width, whole.height);
    u.transparent.value = transparent ? 1 : 0;
    this.pass.draw(renderer, into ?? null);
  }
}
