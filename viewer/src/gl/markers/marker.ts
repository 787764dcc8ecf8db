/**
 * A shape of the scene [mm] that is drawn twice: solid where nothing hides it, and as a faint ghost where bone or
 * tissue stands before it, so that it can always be found.
 */
import * as THREE from "three";
import { distance, normalize, subtract, type Vec3 } from "../../core/geometry/vector";
import { shaders } from "../shaders/shaders";

export const usualGhost = 0.3;

/** One shape, its solid and its ghost. */
export class Marker {
  readonly group = new THREE.Group();
  private readonly colour = new THREE.Vector3();
  private readonly toward = { value: 0 };

  /**
   * @param ghost how much of the opacity is left behind something.
   * @param side which is seen: of a closed shape the front, of a flat one both.
   */
  constructor(
    geometry: THREE.BufferGeometry,
    opacity: number,
    ghostOpacity = usualGhost,
    private readonly side: THREE.Side = THREE.FrontSide,
  ) {
    const solid = new THREE.Mesh(geometry, this.material(opacity, THREE.LessEqualDepth, opacity === 1));
    const ghost = new THREE.Mesh(geometry, this.material(opacity * ghostOpacity, THREE.GreaterDepth, false));
    // ghosts first: a solid marker then covers the ghost of another one
    ghost.renderOrder = 1;
    solid.renderOrder = 2;
    for (const mesh of [ghost, solid]) {
      mesh.frustumCulled = false;
      this.group.add(mesh);
    }
  }

  /** Shows the shape with its local y axis from `from` to `to`, `thick` mm wide. */
  span(from: Vec3, to: Vec3, thick: number): void {
    const long = distance(from, to);
    this.group.visible = long > 1e-6;
    this.group.position.set(...from);
    this.group.scale.set(thick, long, thick);
    this.group.quaternion.setFromUnitVectors(
      new THREE.Vector3(0, 1, 0),
      new THREE.Vector3(...normalize(subtract(to, from))),
    );
  }

  ball(centre: Vec3, radius: number): void {
    this.group.position.set(...centre);
    this.group.scale.setScalar(radius);
  }

  /** Shows a flat shape with its local y axis along a unit normal. */
  plate(centre: Vec3, normal: Vec3, radius: number): void {
    this.ball(centre, radius);
    this.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3(...normal));
  }

  /** Draws it nearer to the eye, where it would else lie in a surface [mm]. */
  lift(toward: number): void {
    this.toward.value = toward;
  }

  paint(colour: Vec3): void {
    this.colour.set(...colour);
  }

  dispose(): void {
    for (const child of this.group.children) {
      const mesh = child as THREE.Mesh<THREE.BufferGeometry, THREE.Material>;
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
  }

  private material(opacity: number, depthFunc: THREE.DepthModes, depthWrite: boolean): THREE.RawShaderMaterial {
    return new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: shaders.marker.vertex,
      fragmentShader: shaders.marker.fragment,
      uniforms: { colour: { value: this.colour }, opacity: { value: opacity }, toward: this.toward },
      transparent: true,
      premultipliedAlpha: true,
      side: this.side,
      depthFunc,
      depthWrite,
    });
  }
}

/** Radius 1, from y = 0 to y = 1. */
export function cylinder(): THREE.BufferGeometry {
  return new THREE.CylinderGeometry(1, 1, 1, 20).translate(0, 0.5, 0);
}

export function cone(): THREE.BufferGeometry {
  return new THREE.ConeGeometry(1, 1, 28).translate(0, 0.5, 0);
}

/** In the plane y = 0, with a rim that is all there is of it. */
export function ring(): THREE.BufferGeometry {
  return new THREE.RingGeometry(0.82, 1, 40).rotateX(-Math.PI / 2);
}
