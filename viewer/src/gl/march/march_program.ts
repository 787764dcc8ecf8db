/**
 * The ray caster's program on the GPU, in its variants. To make one takes seconds where the CPU draws, so a
 * light one is made first, which shows the same scan more roughly (`shaders/march/first.glsl`); the whole one follows
 * when there is a picture.
 */
import * as THREE from "three";
import { FullscreenPass, type Uniforms } from "../base/fullscreen_pass";
import type { PictureTarget } from "../base/picture_target";
import { shaders } from "../shaders/shaders";

type Defines = Readonly<Record<string, string>>;

export class MarchProgram {
  private readonly pass: FullscreenPass;
  private whole: Defines = {};
  /** The light program's variant; null where it cannot show what is to be seen. */
  private light: Defines | null = null;
  /** The light one draws where it can, until the whole one is there. */
  private begins = false;
  private completing: Promise<void> | null = null;
  private disposed = false;

  constructor(private readonly uniforms: Uniforms) {
    this.pass = new FullscreenPass(shaders.march, uniforms);
  }

  /** The picture is drawn with all that belongs to it. */
  get isWhole(): boolean {
    return !this.begins || this.light === null;
  }

  /** Draws a variant from now on; before it is there the light one, where one can show the same. */
  choose(whole: Defines, light: Defines | null): void {
    this.whole = whole;
    this.light = light;
    this.apply();
  }

  /** Has the GPU ready the light program, before there is anything to draw. */
  async prepareFirst(renderer: THREE.WebGLRenderer, target: PictureTarget): Promise<void> {
    this.begins = true;
    this.apply();
    await this.make(renderer, target, this.variant);
  }

  /** Has the GPU make the whole program while the light one draws, and draws with it from then on. */
  async complete(renderer: THREE.WebGLRenderer, target: PictureTarget): Promise<void> {
    if (!this.isWhole) {
      this.completing ??= this.make(renderer, target, this.whole).finally(() => {
        this.begins = false;
        this.apply();
      });
      await this.completing;
    }
  }

  draw(renderer: THREE.WebGLRenderer, target: PictureTarget): void {
    this.pass.draw(renderer, target.target);
  }

  /** Share with which the next drawing is blended over what the target holds; null replaces it. */
  set blend(share: number | null) {
    const { material } = this.pass;
    material.blending = share === null ? THREE.NoBlending : THREE.CustomBlending;
    material.blendSrc = THREE.ConstantAlphaFactor;
    material.blendDst = THREE.OneMinusConstantAlphaFactor;
    material.blendAlpha = share ?? 1;
    // the depth stays that of the first picture
    material.depthWrite = share === null;
  }

  dispose(): void {
    this.disposed = true;
    this.pass.dispose();
  }

  private get variant(): Defines {
    return (this.begins ? this.light : null) ?? this.whole;
  }

  private apply(): void {
    const { material } = this.pass;
    material.defines = { ...this.variant };
    material.needsUpdate = true;
  }

  /** Compiles a variant, and draws a pixel of nothing: some of the work is done with the first drawing. */
  private async make(renderer: THREE.WebGLRenderer, target: PictureTarget, defines: Defines): Promise<void> {
    // no ray has anything before it
    const nothing = { slab: { value: new THREE.Vector2(0, -1) } };
    const trial = new FullscreenPass(shaders.march, { ...this.uniforms, ...nothing });
    trial.material.defines = { ...defines };
    await trial.prepare(renderer);
    if (!this.disposed) {
      trial.draw(renderer, target.target);
      // kept by who draws with it as long as nothing else is to be seen
      this.pass.take(renderer, defines);
    }
    trial.dispose();
  }
}
