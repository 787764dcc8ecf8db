/**
 * Puts the cached picture with its depth into its pane of the screen, over the background.
 */
import * as THREE from "three";
import { linearFromHex } from "../core/colour";
import { FullscreenPass } from "./fullscreen_pass";
import type { PictureTarget } from "./picture_target";
import { shaders } from "./shaders";

const centre = linearFromHex("#1b222b");
const rim = linearFromHex("#0b0e12");

export class Compositor {
  private readonly uniforms = {
    picture: { value: null as THREE.Texture | null },
    pictureDepth: { value: null as THREE.Texture | null },
    share: { value: new THREE.Vector2(1, 1) },
    used: { value: new THREE.Vector2(1, 1) },
    paneCorner: { value: new THREE.Vector2() },
    paneSize: { value: new THREE.Vector2(1, 1) },
    bend: { value: 1 },
    backgroundCentre: { value: new THREE.Vector3(...centre) },
    backgroundEdge: { value: new THREE.Vector3(...rim) },
  };
  private readonly pass = new FullscreenPass(shaders.composite, this.uniforms);

  /** Whether highlights are bent instead of clipped; grey by window and level is shown as it is. */
  set bendsHighlights(on: boolean) {
    this.uniforms.bend.value = on ? 1 : 0;
  }

  /** Draws into the renderer's viewport, whose lower left corner is given [device pixels]. */
  draw(renderer: THREE.WebGLRenderer, source: PictureTarget, corner: readonly [number, number]): void {
    const u = this.uniforms;
    const { target, width, height } = source;
    u.picture.value = target.texture;
    u.pictureDepth.value = target.depthTexture;
    u.share.value.set(width / target.width, height / target.height);
    u.used.value.set(width, height);
    u.paneCorner.value.set(...corner);
    u.paneSize.value.set(target.width, target.height);
    this.pass.draw(renderer, null);
  }

  dispose(): void {
    this.pass.dispose();
  }
}
