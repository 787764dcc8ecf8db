/**
 * The recent way of the probe: a line of constant width on the screen that fades with age.
 * Like the markers it is drawn twice: plain where nothing hides it, and faint behind.
 */
import * as THREE from "three";
import { pieceNumbers, type PathTrail } from "../core/path_trail";
import type { Vec3 } from "../core/vector";
import { shaders } from "./shaders";

/** Half the width of the line, and how far it is drawn toward the eye [CSS pixels]. */
const halfWidth = 1.6;
const toward = 4;
const strength = { plain: 0.85, behind: 0.18 } as const;

/** Pieces drawn, at most. */
export const mostPieces = 512;

export class PathRibbon {
  readonly group = new THREE.Group();
  private readonly pieces = new Float32Array(pieceNumbers * mostPieces);
  private readonly buffer = new THREE.InstancedInterleavedBuffer(this.pieces, pieceNumbers);
  private readonly geometry = new THREE.InstancedBufferGeometry();
  private readonly uniforms = {
    pixel: { value: 1 },
    halfWidth: { value: halfWidth },
    toward: { value: toward },
    colour: { value: new THREE.Vector3() },
  };

  constructor(colour: Vec3) {
    this.uniforms.colour.value.set(...colour);
    this.buffer.setUsage(THREE.DynamicDrawUsage);
    // x along the piece, y across it
    const corners = new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]);
    this.geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    this.geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.geometry.setAttribute("start", new THREE.InterleavedBufferAttribute(this.buffer, 3, 0));
    this.geometry.setAttribute("end", new THREE.InterleavedBufferAttribute(this.buffer, 3, 3));
    this.geometry.setAttribute("fresh", new THREE.InterleavedBufferAttribute(this.buffer, 2, 6));
    this.geometry.instanceCount = 0;
    const behind = new THREE.Mesh(this.geometry, this.material(strength.behind, THREE.GreaterDepth));
    const plain = new THREE.Mesh(this.geometry, this.material(strength.plain, THREE.LessEqualDepth));
    for (const mesh of [behind, plain]) {
      mesh.frustumCulled = false;
      // under the probe and its arrows
      mesh.renderOrder = 0;
      this.group.add(mesh);
    }
  }

  /** @param pixel size of a CSS pixel at the probe [mm]. */
  update(trail: PathTrail, pixel: number): void {
    this.geometry.instanceCount = trail.write(this.pieces);
    this.buffer.needsUpdate = true;
    this.uniforms.pixel.value = pixel;
  }

  dispose(): void {
    this.geometry.dispose();
    for (const child of this.group.children) {
      (child as THREE.Mesh<THREE.BufferGeometry, THREE.Material>).material.dispose();
    }
  }

  private material(opacity: number, depthFunc: THREE.DepthModes): THREE.RawShaderMaterial {
    return new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: shaders.path.vertex,
      fragmentShader: shaders.path.fragment,
      uniforms: { ...this.uniforms, opacity: { value: opacity } },
      transparent: true,
      premultipliedAlpha: true,
      side: THREE.DoubleSide,
      depthFunc,
      depthWrite: false,
    });
  }
}
