/**
 * Draws one triangle over a whole target with a shader of our own.
 */
import * as THREE from "three";
import { shaders } from "./shaders";

export type Uniforms = Record<string, THREE.IUniform>;

export class FullscreenPass {
  readonly material: THREE.RawShaderMaterial;
  private readonly mesh: THREE.Mesh;
  private readonly camera = new THREE.Camera();

  constructor(fragmentShader: string, uniforms: Uniforms) {
    this.material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: shaders.fullscreen,
      fragmentShader,
      uniforms,
      depthFunc: THREE.AlwaysDepth,
      depthWrite: true,
      blending: THREE.NoBlending,
    });
    const triangle = new THREE.BufferGeometry();
    triangle.setAttribute("position", new THREE.Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3));
    this.mesh = new THREE.Mesh(triangle, this.material);
    this.mesh.frustumCulled = false;
  }

  /** Draws into the target, of a 3-D one into a layer, or onto the screen. */
  draw(renderer: THREE.WebGLRenderer, target: THREE.WebGLRenderTarget | null, layer = 0): void {
    renderer.setRenderTarget(target, layer);
    renderer.render(this.mesh, this.camera);
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.material.dispose();
  }
}
