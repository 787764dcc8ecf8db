/**
 * Draws one triangle over a whole target with a shader of our own.
 */
import * as THREE from "three";
import { shaders } from "../shaders/shaders";

/** Between two looks whether a shader is compiled. */
const pollMilliseconds = 10;

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

  /** Has the GPU compile the shader, and waits for that without holding the page up (KHR_parallel_shader_compile). */
  async prepare(renderer: THREE.WebGLRenderer): Promise<void> {
    renderer.compile(this.mesh, this.camera);
    const isReady = (): boolean => {
      // disposed meanwhile, it has none
      const { currentProgram } = renderer.properties.get(this.material) as {
        currentProgram?: { isReady: () => boolean };
      };
      return currentProgram?.isReady() ?? true;
    };
    while (!isReady()) {
      await new Promise((resolve) => setTimeout(resolve, pollMilliseconds));
    }
  }

  /** Takes up a variant that another pass with the same shader has made. */
  take(renderer: THREE.WebGLRenderer, defines: Readonly<Record<string, string>>): void {
    const { material } = this;
    const chosen = material.defines;
    material.defines = { ...defines };
    material.needsUpdate = true;
    renderer.compile(this.mesh, this.camera);
    if (chosen !== undefined && JSON.stringify(chosen) !== JSON.stringify(defines)) {
      // something else is to be seen by now
      material.defines = chosen;
      material.needsUpdate = true;
    }
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
