/**
 * Puts a picture of the engine, with its depth, into a cached picture.
 */
import * as THREE from "three";
import type { DrawnPicture } from "../../core/protocol";
import { FullscreenPass } from "../base/fullscreen_pass";
import type { PictureTarget } from "../base/picture_target";
import type { RayMarcher } from "../march/ray_marcher";
import { shaders } from "../shaders/shaders";

export class EnginePass {
  private readonly uniforms;
  private readonly pass: FullscreenPass;

  constructor(marcher: RayMarcher) {
    this.uniforms = {
      engineColour: { value: null as THREE.DataTexture | null },
      engineDepth: { value: null as THREE.DataTexture | null },
      depthSpan: { value: new THREE.Vector2() },
      ...marcher.placeUniforms,
    };
    this.pass = new FullscreenPass(shaders.engine, this.uniforms);
    this.pass.material.defines = { LAYERS: "0" };
  }

  async prepare(renderer: THREE.WebGLRenderer): Promise<void> {
    await this.pass.prepare(renderer);
  }

  /** Draws into the part in use, which is as large as the picture. */
  draw(renderer: THREE.WebGLRenderer, target: PictureTarget, picture: DrawnPicture): void {
    const u = this.uniforms;
    const [width, height] = picture.size;
    const size = [width, height] as const;
    u.engineColour.value = filled(u.engineColour.value, size, colourTexture, halves(picture.colours));
    u.engineDepth.value = filled(u.engineDepth.value, size, depthTexture, halves(picture.depths));
    u.depthSpan.value.set(picture.nearest, picture.farthest);
    this.pass.draw(renderer, target.target);
  }

  dispose(): void {
    this.uniforms.engineColour.value?.dispose();
    this.uniforms.engineDepth.value?.dispose();
    this.pass.dispose();
  }
}

/** 16-bit values; they may lie anywhere in the message. */
function halves(bytes: Uint8Array): Uint16Array {
  return new Uint16Array(bytes.slice().buffer);
}

/** The texture with other values, or a new one where it had another size. */
function filled(
  texture: THREE.DataTexture | null,
  [width, height]: readonly [number, number],
  make: (values: Uint16Array, width: number, height: number) => THREE.DataTexture,
  values: Uint16Array,
): THREE.DataTexture {
  if (texture?.image.width !== width || texture.image.height !== height) {
    texture?.dispose();
    texture = make(values, width, height);
  }
  texture.image.data = values;
  texture.needsUpdate = true;
  return texture;
}

function colourTexture(values: Uint16Array, width: number, height: number): THREE.DataTexture {
  return new THREE.DataTexture(values, width, height, THREE.RGBAFormat, THREE.HalfFloatType);
}

function depthTexture(values: Uint16Array, width: number, height: number): THREE.DataTexture {
  const texture = new THREE.DataTexture(values, width, height, THREE.RedIntegerFormat, THREE.UnsignedShortType);
  texture.internalFormat = "R16UI";
  return texture;
}
