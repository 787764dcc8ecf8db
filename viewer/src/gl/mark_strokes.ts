/**
 * Marks in the 3-D view: lines of constant width on the screen, and rings at their points. Like the markers of
 * touch each is drawn twice: plain where nothing hides it, faint behind bone or tissue.
 */
import * as THREE from "three";
import { srgbFromHex } from "../core/colour";
import type { Vec3 } from "../core/vector";
import { shaders } from "./shaders";

/** Half the width of a line, with its halo, radius of a ring, half the square it is drawn in, and how far toward the eye [CSS pixels]. */
const halfLine = 0.9;
const reach = [2.2, 6.5] as const;
const ring = 4;
const toward = 6;
const strength = { plain: 1, behind: 0.3 } as const;

/** Numbers of a piece: from (x, y, z), to (x, y, z); both are one place for a point. */
const pieceNumbers = 6;

export class MarkStrokes {
  readonly scene = new THREE.Scene();
  private readonly geometry = new THREE.InstancedBufferGeometry();
  private readonly uniforms = {
    height: { value: 1 },
    reach: { value: new THREE.Vector2(...reach) },
    toward: { value: toward },
    // as in theme.css
    colour: { value: new THREE.Vector3(...srgbFromHex("#ff9ad5")) },
    halfLine: { value: halfLine },
    ring: { value: ring },
  };

  constructor() {
    // x along the piece, y across it
    this.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]), 3));
    this.geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.show([]);
    // faint ones first: a plain line then covers what is behind
    for (const [renderOrder, depthFunc, opacity] of [[0, THREE.GreaterDepth, strength.behind], [1, THREE.LessEqualDepth, strength.plain]] as const) {
      const mesh = new THREE.Mesh(this.geometry, this.material(opacity, depthFunc));
      mesh.frustumCulled = false;
      mesh.renderOrder = renderOrder;
      this.scene.add(mesh);
    }
  }

  /** @param lines points of each mark, in their order; scene [mm]. */
  show(lines: readonly (readonly Vec3[])[]): void {
    const pieces = lines.flatMap((points) => [
      ...points.slice(1).map((point, i) => [...(points[i] ?? point), ...point]),
      ...points.map((point) => [...point, ...point]),
    ]);
    // gives the buffers of what was shown back
    this.geometry.dispose();
    const buffer = new THREE.InstancedInterleavedBuffer(new Float32Array(pieces.flat()), pieceNumbers);
    this.geometry.setAttribute("start", new THREE.InterleavedBufferAttribute(buffer, 3, 0));
    this.geometry.setAttribute("end", new THREE.InterleavedBufferAttribute(buffer, 3, 3));
    this.geometry.instanceCount = pieces.length;
    this.scene.visible = pieces.length > 0;
  }

  /** @param height of what is seen [CSS pixels]. */
  draw(renderer: THREE.WebGLRenderer, camera: THREE.Camera, height: number): void {
    if (this.scene.visible) {
      this.uniforms.height.value = height;
      renderer.render(this.scene, camera);
    }
  }

  dispose(): void {
    this.geometry.dispose();
    for (const child of this.scene.children) {
      (child as THREE.Mesh<THREE.BufferGeometry, THREE.Material>).material.dispose();
    }
  }

  private material(opacity: number, depthFunc: THREE.DepthModes): THREE.RawShaderMaterial {
    return new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: shaders.mark.vertex,
      fragmentShader: shaders.mark.fragment,
      uniforms: { ...this.uniforms, opacity: { value: opacity } },
      transparent: true,
      premultipliedAlpha: true,
      side: THREE.DoubleSide,
      depthFunc,
      depthWrite: false,
    });
  }
}
