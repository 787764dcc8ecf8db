/**
 * The cached picture of the scan: colour (premultiplied, linear) and depth. Coarser levels
 * use its lower left part, so that no level needs memory of its own.
 */
import * as THREE from "three";

export class PictureTarget {
  readonly target: THREE.WebGLRenderTarget;
  /** Part in use [texels]. */
  width = 1;
  height = 1;
  /** Where it is a tile: the size of the whole picture, and where its lower left corner lies in it [texels]. */
  tile: { readonly width: number; readonly height: number; readonly x: number; readonly y: number } | null = null;

  /** @param depthType of the depth's texels. */
  constructor(halfFloat: boolean, depthType: THREE.TextureDataType = THREE.UnsignedIntType) {
    this.target = new THREE.WebGLRenderTarget(1, 1, {
      type: halfFloat ? THREE.HalfFloatType : THREE.UnsignedByteType,
      minFilter: THREE.LinearFilter,
      magFilter: THREE.LinearFilter,
      generateMipmaps: false,
      depthTexture: new THREE.DepthTexture(1, 1, depthType),
    });
  }

  resize(width: number, height: number): void {
    const { target } = this;
    if (width === target.width && height === target.height) {
      return;
    }
    // three.js gives the depth the size that it had when it was read, even before anything was drawn
    target.depthTexture?.dispose();
    Object.assign(target.depthTexture?.image ?? {}, { width, height });
    target.setSize(width, height);
  }

  /** Uses the part that a divided resolution needs. */
  useLevel(divisor: number): void {
    this.width = Math.ceil(this.target.width / divisor);
    this.height = Math.ceil(this.target.height / divisor);
    this.target.viewport.set(0, 0, this.width, this.height);
  }

  /** Restricts drawing to rows of the part in use, and to columns of it. */
  useRows(from: number, to: number, left = 0, right = this.width): void {
    this.target.scissor.set(left, from, right - left, to - from);
    this.target.scissorTest = true;
  }

  dispose(): void {
    this.target.depthTexture?.dispose();
    this.target.dispose();
  }
}
