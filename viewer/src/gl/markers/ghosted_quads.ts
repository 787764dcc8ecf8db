/**
 * Many small flat shapes in the scene, an instance each, that their shader turns to the viewer. Each is drawn
 * twice: plain where nothing hides it, and faint behind bone or tissue.
 */
import * as THREE from "three";

/** Opacities: where nothing hides a shape, and behind something. */
export interface Strength {
  readonly plain: number;
  readonly behind: number;
}

/** Corners of a piece of a line, x along it and y across it; and of a square around a point. */
export const strip = [0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0] as const;
export const square = [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0] as const;

export class GhostedQuads {
  readonly group = new THREE.Group();
  /** What each instance is, is set by its owner. */
  readonly geometry = new THREE.InstancedBufferGeometry();
  private readonly materials: readonly THREE.Material[];

  constructor(
    corners: readonly number[],
    shader: { readonly vertex: string; readonly fragment: string },
    uniforms: Record<string, THREE.IUniform>,
    { plain, behind }: Strength,
  ) {
    this.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(corners), 3));
    this.geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.geometry.instanceCount = 0;
    const material = (opacity: number, depthFunc: THREE.DepthModes): THREE.Material =>
      new THREE.RawShaderMaterial({
        glslVersion: THREE.GLSL3,
        vertexShader: shader.vertex,
        fragmentShader: shader.fragment,
        uniforms: { ...uniforms, opacity: { value: opacity } },
        transparent: true,
        premultipliedAlpha: true,
        side: THREE.DoubleSide,
        depthFunc,
        depthWrite: false,
      });
    // faint ones first: a plain one then covers what is behind
    this.materials = [material(behind, THREE.GreaterDepth), material(plain, THREE.LessEqualDepth)];
    for (const each of this.materials) {
      const mesh = new THREE.Mesh(this.geometry, each);
      mesh.frustumCulled = false;
      this.group.add(mesh);
    }
  }

  dispose(): void {
    this.geometry.dispose();
    for (const material of this.materials) {
      material.dispose();
    }
  }
}
