/**
 * Gives a finer cached picture what a coarser one shows: so its pieces can be seen as they are drawn, one by one.
 */
import * as THREE from "three";
import { FullscreenPass } from "../base/fullscreen_pass";
import type { PictureTarget } from "../base/picture_target";
import { shaders } from "../shaders/shaders";

export class Stretcher {
  private readonly uniforms = {
    picture: { value: null as THREE.Texture | null },
    pictureDepth: { value: null as THREE.Texture | null },
    share: { value: new THREE.Vector2() },
    used: { value: new THREE.Vector2() },
    size: { value: new THREE.Vector2() },
  };
  private readonly pass = new FullscreenPass(shaders.stretch, this.uniforms);

  async prepare(renderer: THREE.WebGLRenderer): Promise<void> {
    await this.pass.prepare(renderer);
  }

  /** Fills the part in use of one picture with that of another. */
  draw(renderer: THREE.WebGLRenderer, from: PictureTarget, to: PictureTarget): void {
    const { target, width, height } = from;
    const u = this.uniforms;
    u.picture.value = target.texture;
    u.pictureDepth.value = target.depthTexture;
    u.share.value.set(width / target.width, height / target.height);
    u.used.value.set(width, height);
    u.size.value.set(to.width, to.height);
    to.useRows(0, to.height);
    this.pass.draw(renderer, to.target);
  }

  dispose(): void {
    this.pass.dispose();
  }
}
