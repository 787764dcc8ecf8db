/**
 * Puts a picture of the engine, with its depth, into a cached picture.
 */
import * as THREE from "three";
import { FullscreenPass } from "../base/fullscreen_pass";
import type { PictureTarget } from "../base/picture_target";
import type { RayMarcher } from "../march/ray_marcher";
import { shaders } from "../shaders/shaders";
import { texelSize, type PictureTexels } from "./picture_texels";

/** Depths of a picture as `engine.frag` has them. */
export interface DepthUniforms {
  readonly engineDepth: THREE.IUniform<THREE.DataTexture | null>;
  readonly depthSpan: THREE.IUniform<THREE.Vector2>;
  readonly ofEyes: THREE.IUniform<THREE.Vector2>;
  readonly fit: THREE.IUniform<THREE.Vector2>;
}

export class EnginePass {
  private readonly uniforms;
  private readonly pass: FullscreenPass;

  constructor(marcher: RayMarcher) {
    this.uniforms = {
      engineColour: { value: null as THREE.Texture | null },
      engineDepth: { value: null as THREE.DataTexture | null },
      depthSpan: { value: new THREE.Vector2() },
      brightest: { value: 0 },
      engineSize: { value: new THREE.Vector2() },
      partFirst: { value: new THREE.Vector2() },
      partSize: { value: new THREE.Vector2() },
      ofEyes: { value: new THREE.Vector2(0, 1) },
      used: { value: new THREE.Vector2() },
      fit: { value: new THREE.Vector2() },
      ...marcher.placeUniforms,
    };
    this.pass = new FullscreenPass(shaders.engine, this.uniforms);
    this.pass.material.defines = { LAYERS: "0" };
  }

  /** How deep what it shows lies, and where that is in the target. */
  get depthUniforms(): DepthUniforms {
    const { engineDepth, depthSpan, ofEyes, fit } = this.uniforms;
    return { engineDepth, depthSpan, ofEyes, fit };
  }

  async prepare(renderer: THREE.WebGLRenderer): Promise<void> {
    await this.pass.prepare(renderer);
  }

  /** Takes a picture, or a part of one, to the GPU. */
  take({ picture, colours, depths, depthSize }: PictureTexels): void {
    const u = this.uniforms;
    const isRaw = colours instanceof Uint16Array;
    u.engineColour.value = isRaw
      ? filled(u.engineColour.value, texelSize(picture), colourTexture, colours)
      : unpackedTexture(u.engineColour.value, colours);
    u.engineDepth.value = filled(u.engineDepth.value, depthSize, depthTexture, depths);
    u.brightest.value = isRaw ? 0 : picture.brightest;
    u.partSize.value.set(...picture.size);
    u.ofEyes.value.set(0, picture.eyes);
    u.depthSpan.value.set(picture.nearest, picture.farthest);
  }

  /** Turns to what an eye sees; where there are fewer pictures than eyes, the last is seen by all others. */
  turn(eye: number): void {
    const { value } = this.uniforms.ofEyes;
    value.x = Math.min(eye, value.y - 1);
  }

  /**
   * Draws it, all of a picture, into the part in use.
   *
   * @param wider how much wider is what the target shows than what was asked for, for its height: that may be of a view
   * of another size by now, and shows less or more at its sides then.
   */
  draw(renderer: THREE.WebGLRenderer, target: PictureTarget, wider = 1): void {
    const u = this.uniforms;
    u.engineSize.value.copy(u.partSize.value);
    u.partFirst.value.set(0, 0);
    u.used.value.set(target.width, target.height);
    // the height of a view is the same in all sizes
    u.fit.value.set(wider, 1);
    target.useRows(0, target.height);
    this.pass.draw(renderer, target.target);
  }

  /** Draws it over a picture of its size in the part in use; it begins at a column and row there. */
  drawPart(renderer: THREE.WebGLRenderer, target: PictureTarget, first: readonly [number, number]): void {
    const u = this.uniforms;
    const { x: columns, y: rows } = u.partSize.value;
    u.engineSize.value.set(target.width, target.height);
    u.partFirst.value.set(...first);
    u.used.value.set(target.width, target.height);
    u.fit.value.set(1, 1);
    const upper = target.height - first[1];
    target.useRows(upper - rows, upper, first[0], first[0] + columns);
    this.pass.draw(renderer, target.target);
  }

  dispose(): void {
    this.uniforms.engineColour.value?.dispose();
    this.uniforms.engineDepth.value?.dispose();
    this.pass.dispose();
  }
}

/** The texture with other values, or a new one where it had another size. */
function filled(
  texture: THREE.Texture | null,
  [width, height]: readonly [number, number],
  make: (values: Uint16Array, width: number, height: number) => THREE.DataTexture,
  values: Uint16Array,
): THREE.DataTexture {
  if (texture instanceof THREE.DataTexture && texture.image.width === width && texture.image.height === height) {
    texture.image.data = values;
    texture.needsUpdate = true;
    return texture;
  }
  texture?.dispose();
  const made = make(values, width, height);
  made.needsUpdate = true;
  return made;
}

function unpackedTexture(before: THREE.Texture | null, image: ImageBitmap): THREE.Texture {
  before?.dispose();
  const texture = new THREE.Texture(image);
  texture.minFilter = THREE.NearestFilter;
  texture.magFilter = THREE.NearestFilter;
  texture.generateMipmaps = false;
  // as it was unpacked: rows from the upper edge
  texture.flipY = false;
  texture.colorSpace = THREE.NoColorSpace;
  texture.onUpdate = () => { image.close(); };
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
