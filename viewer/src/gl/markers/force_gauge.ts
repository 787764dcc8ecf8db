/**
 * The ring around the probe that shows how large the force is, from every side.
 */
import * as THREE from "three";
import type { Vec3 } from "../../core/geometry/vector";
import { shaders } from "../shaders/shaders";

/** Half the ring's square [CSS pixels]. */
const reachPixels = 17;

export class ForceGauge {
  readonly mesh: THREE.Mesh<THREE.PlaneGeometry, THREE.RawShaderMaterial>;
  private readonly uniforms = {
    centre: { value: new THREE.Vector3() },
    reach: { value: 1 },
    share: { value: 0 },
    pixel: { value: 1 / reachPixels },
    colour: { value: new THREE.Vector3() },
  };

  constructor(colour: Vec3) {
    this.uniforms.colour.value.set(...colour);
    const material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: shaders.gauge.vertex,
      fragmentShader: shaders.gauge.fragment,
      uniforms: this.uniforms,
      transparent: true,
      premultipliedAlpha: true,
      // read at a glance, also while the probe is behind something
      depthTest: false,
      depthWrite: false,
    });
    this.mesh = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 3;
  }

  /** @param share of the largest force, 0..1. @param pixel size of a CSS pixel there [mm]. */
  update(centre: Vec3, share: number, pixel: number): void {
    this.uniforms.centre.value.set(...centre);
    this.uniforms.reach.value = reachPixels * pixel;
    this.uniforms.share.value = share;
    this.mesh.visible = share > 0;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
