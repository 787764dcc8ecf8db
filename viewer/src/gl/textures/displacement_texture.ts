/**
 * Displacements of tissue, on the GPU: the boxes of nodes one above the other in one texture.
 * Keep in sync with `shaders/scan/displacements.glsl`.
 */
import * as THREE from "three";
import type { Displacements } from "../../core/scan/displacements";
import type { Vec3 } from "../../core/geometry/vector";

/** Boxes whose displacements add up, at most. */
const boxes = 2;
/** Half floats of a node. */
const numbers = 4;

export class DisplacementTexture {
  readonly uniforms = {
    displacedTexture: { value: null as THREE.Data3DTexture | null },
    displacedScale: { value: vectors() },
    displacedOffset: { value: vectors() },
    displacedPart: { value: vectors() },
    displacedStart: { value: vectors() },
    displacedEdge: { value: vectors() },
    displacedFarthest: { value: 0 },
  };
  private size: Vec3 = [0, 0, 0];

  constructor() {
    this.set([]);
  }

  /** Takes other displacements; none where no tissue is displaced. */
  set(displaced: readonly Displacements[]): void {
    const shown = displaced.slice(0, boxes);
    const longest = (axis: 0 | 1): number => Math.max(1, ...shown.map(({ size }) => size[axis]));
    const layers = shown.reduce((sum, { size }) => sum + size[2], 0);
    const size: Vec3 = [longest(0), longest(1), Math.max(1, layers)];
    this.fill(size, stacked(shown, size));
    let first = 0;
    for (let i = 0; i < boxes; ++i) {
      const box = shown[i];
      this.place(i, box, size, first);
      first += box?.size[2] ?? 0;
    }
    this.uniforms.displacedFarthest.value = shown.reduce((sum, box) => sum + farthest(box), 0);
  }

  dispose(): void {
    this.uniforms.displacedTexture.value?.dispose();
  }

  /** Where a box lies in the grid, and in the texture from a layer on. */
  private place(i: number, box: Displacements | undefined, whole: Vec3, first: number): void {
    const u = this.uniforms;
    const set = (vector: { readonly value: THREE.Vector3[] }, of: (axis: 0 | 1 | 2) => number): void => {
      vector.value[i]?.set(of(0), of(1), of(2));
    };
    if (box === undefined) {
      // every place is outside
      set(u.displacedScale, () => 0);
      set(u.displacedOffset, () => 2);
      return;
    }
    const { origin, step, size } = box;
    // nodes are texel centres
    set(u.displacedScale, (axis) => 1 / (step[axis] * size[axis]));
    set(u.displacedOffset, (axis) => (0.5 - origin[axis] / step[axis]) / size[axis]);
    set(u.displacedPart, (axis) => size[axis] / whole[axis]);
    set(u.displacedStart, (axis) => (axis === 2 ? first / whole[2] : 0));
    set(u.displacedEdge, (axis) => 0.5 / size[axis]);
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

function vectors(): THREE.Vector3[] {
  return Array.from({ length: boxes }, () => new THREE.Vector3());
}

/** The nodes of boxes one above the other, in a box that is as wide and deep as the largest. */
function stacked(shown: readonly Displacements[], [width, depth, layers]: Vec3): Uint16Array<ArrayBuffer> {
  const [only, ...others] = shown;
  if (only !== undefined && others.length === 0) {
    return only.moved;
  }
  const all = new Uint16Array(numbers * width * depth * layers);
  let row = 0;
  for (const { size, moved } of shown) {
    const length = numbers * size[0];
    for (let layer = 0; layer < size[2]; ++layer) {
      for (let y = 0; y < size[1]; ++y) {
        const from = (layer * size[1] + y) * length;
        all.set(moved.subarray(from, from + length), numbers * width * (row + y));
      }
      row += depth;
    }
  }
  return all;
}

/** No node of a box moves farther along an axis [mm]. */
function farthest({ moved }: Displacements): number {
  // without their sign half floats are ordered as their bits are
  const most = moved.reduce((bits, number) => Math.max(bits, number & 0x7fff), 0);
  return THREE.DataUtils.fromHalfFloat(most);
}
