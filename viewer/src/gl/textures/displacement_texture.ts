/**
 * Displacements of tissue, on the GPU. Keep in sync with `shaders/scan/displacements.glsl`.
 */
import * as THREE from "three";
import type { Displacements } from "../../core/scan/displacements";
import type { Vec3 } from "../../core/geometry/vector";

export class DisplacementTexture {
  readonly uniforms = {
    displacedTexture: { value: null as THREE.Data3DTexture | null },
    displacedScale: { value: new THREE.Vector3() },
    displacedOffset: { value: new THREE.Vector3() },
  };
  private size: Vec3 = [0, 0, 0];

  constructor() {
    this.set(null);
  }

  /** Takes other displacements; null where no tissue is displaced. */
  set(displaced: Displacements | null): void {
    const { size, moved } = displaced ?? { size: [1, 1, 1] as const, moved: new Uint16Array(4) };
    this.fill(size, moved);
    const { displacedScale, displacedOffset } = this.uniforms;
    if (displaced === null) {
      // every place is outside
      displacedScale.value.setScalar(0);
      displacedOffset.value.setScalar(2);
      return;
    }
    const { origin, step } = displaced;
    // nodes are texel centres
    displacedScale.value.set(1 / (step[0] * size[0]), 1 / (step[1] * size[1]), 1 / (step[2] * size[2]));
    const first = (axis: 0 | 1 | 2): number => (0.5 - origin[axis] / step[axis]) / size[axis];
    displacedOffset.value.set(first(0), first(1), first(2));
  }

  dispose(): void {
    this.uniforms.displacedTexture.value?.dispose();
  }

  private fill(size: Vec3, moved: Uint16Array<ArrayBuffer>): void {
    const { displacedTexture } = this.uniforms;
    const held = displacedTexture.value;
    if (held !== null && size.every((nodes, axis) => nodes === this.size[axis])) {
      held.image.data = moved;
      held.needsUpdate = true;
      return;
    }
    held?.dispose();
    this.size = size;
    const texture = new THREE.Data3DTexture(moved, ...size);
    texture.format = THREE.RGBAFormat;
    texture.type = THREE.HalfFloatType;
    texture.minFilter = THREE.LinearFilter;
    texture.magFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    displacedTexture.value = texture;
  }
}
