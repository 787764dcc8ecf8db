/**
 * Enlarges a coarse picture that was put together at its own size: so a slow renderer works out colours for its few
 * pixels, and not for all of the pane.
 */
import * as THREE from "three";
import { FullscreenPass } from "../base/fullscreen_pass";
import type { PictureTarget } from "../base/picture_target";
import { shaders } from "../shaders/shaders";

/** Where the screen shows a picture: lower left corner, and size [pixels of the screen as it is drawn]. */
export interface ScreenPane {
  readonly corner: readonly [number, number];
  readonly size: readonly [number, number];
}

export class Upscaler {
  /** The picture as it would stand on the screen, as small as it is. */
  readonly small = new THREE.WebGLRenderTarget(1, 1, { generateMipmaps: false, depthBuffer: false });
  private readonly uniforms = {
    small: { value: this.small.texture },
    pictureDepth: { value: null as THREE.Texture | null },
    used: { value: new THREE.Vector2() },
    paneCorner: { value: new THREE.Vector2() },
    paneSize: { value: new THREE.Vector2() },
  };
  private readonly pass = new FullscreenPass(shaders.enlarge, this.uniforms);

  async prepare(renderer: THREE.WebGLRenderer): Promise<void> {
    await this.pass.prepare(renderer);
  }

  /** Draws into a pane of the screen. */
  draw(renderer: THREE.WebGLRenderer, { target, width, height }: PictureTarget, { corner, size }: ScreenPane): void {
    const u = this.uniforms;
    u.pictureDepth.value = target.depthTexture;
    u.used.value.set(width, height);
    u.paneCorner.value.set(...corner);
    u.paneSize.value.set(...size);
    this.pass.draw(renderer, null);
  }

  dispose(): void {
    this.small.dispose();
    this.pass.dispose();
  }
}
