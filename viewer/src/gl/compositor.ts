/**
 * Puts the cached picture with its depth onto the screen, over the background.
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
    screenSize: { value: new THREE.Vector2(1, 1) },
    backgroundCentre: { value: new THREE.Vector3(...centre) },
    backgroundEdge: { value: new THREE.Vector3(...rim) },
  };
  private readonly pass = new FullscreenPass(shaders.composite, this.uniforms);

  draw(renderer: THREE.WebGLRenderer, source: PictureTarget): void {
    const u = this.uniforms;
    const { target, width, height } = source;
    u.picture.value = target.texture;
    u.pictureDepth.value = target.depthTexture;
    u.share.value.set(width / target.width, height / target.height);
    u.used.value.set(width, height);
    renderer.getDrawingBufferSize(u.screenSize.value);
    this.pass.draw(renderer, null);
  }

  dispose(): void {
    this.pass.dispose();
  }
}
