/** The nodes or particles of a model of deformation, coloured by strain: a disc each. */
import * as THREE from "three";
import { srgbFromHex } from "../../core/base/colour";
import type { ModelParticles } from "../../core/tissue/particles";
import type { Vec3 } from "../../core/geometry/vector";
import { GhostedQuads, square } from "./ghosted_quads";
import { shaders } from "../shaders/shaders";

/** Radius of a disc [distance of neighbours]. */
const discRadius = 0.28;
const strength = { plain: 0.95, behind: 0.6 } as const;

export class ParticleDots {
  private readonly uniforms = {
    boxOrigin: { value: new THREE.Vector3() },
    boxSize: { value: new THREE.Vector3() },
    radius: { value: 1 },
    pressed: { value: new THREE.Vector3(...srgbFromHex("#4aa8ff")) },
    resting: { value: new THREE.Vector3(...srgbFromHex("#e6edf5")) },
    pulled: { value: new THREE.Vector3(...srgbFromHex("#ff8a3c")) },
  };
  private readonly quads = new GhostedQuads(square, shaders.parts, this.uniforms, strength);
  readonly group = this.quads.group;
  private shown: ModelParticles | null = null;
  private room = 0;

  constructor() {
    this.group.visible = false;
  }

  /** Shows other parts; none with null. */
  update(parts: ModelParticles | null): void {
    if (parts === this.shown) {
      return;
    }
    this.shown = parts;
    this.group.visible = parts !== null && parts.count > 0;
    if (parts === null) {
      return;
    }
    this.uniforms.boxOrigin.value.set(...parts.origin);
    this.uniforms.boxSize.value.set(...parts.size);
    this.uniforms.radius.value = discRadius * parts.apart;
    this.fill(parts);
  }

  /** Corners of what is drawn. */
  get outline(): readonly Vec3[] {
    if (this.shown === null) {
      return [];
    }
    const { origin, size } = this.shown;
    const corner = (i: number): Vec3 => [
      origin[0] + (i & 1 ? size[0] : 0),
      origin[1] + (i & 2 ? size[1] : 0),
      origin[2] + (i & 4 ? size[2] : 0),
    ];
    return [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
  }

  dispose(): void {
    this.quads.dispose();
  }

  private fill({ places, strains, count }: ModelParticles): void {
    const { geometry } = this.quads;
    if (count > this.room) {
      // other buffers: what the GPU holds of those before goes with them
      geometry.dispose();
      this.room = 2 ** Math.ceil(Math.log2(count));
      geometry.setAttribute("place", instanced(new Uint16Array(3 * this.room), 3));
      geometry.setAttribute("strain", instanced(new Int8Array(this.room), 1));
    }
    geometry.instanceCount = count;
    for (const [name, values] of [["place", places], ["strain", strains]] as const) {
      const attribute = geometry.getAttribute(name) as THREE.InstancedBufferAttribute;
      attribute.array.set(values);
      attribute.needsUpdate = true;
    }
  }
}

/** An attribute of each disc, as a share of its range. */
function instanced(values: Uint16Array | Int8Array, size: number): THREE.InstancedBufferAttribute {
  return new THREE.InstancedBufferAttribute(values, size, true).setUsage(THREE.DynamicDrawUsage);
}
