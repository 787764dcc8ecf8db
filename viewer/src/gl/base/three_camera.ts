/**
 * Our camera as one of three.js, for the meshes of the scene.
 */
import * as THREE from "three";
import { eyeOf, nearAndFar, type Camera, type Extent } from "../../core/geometry/camera";

export class ThreeCamera {
  readonly camera = new THREE.Camera();

  constructor() {
    this.camera.matrixAutoUpdate = false;
    this.camera.matrixWorldAutoUpdate = false;
  }

  update(view: Camera, extent: Extent, aspect: number): void {
    const { near, far } = nearAndFar(view, extent);
    const { parallel } = view;
    const top = (parallel === null ? near : view.distance) * Math.tan(view.field / 2);
    const right = top * aspect;
    const { camera } = this;
    camera.matrixWorld
      .makeBasis(new THREE.Vector3(...view.right), new THREE.Vector3(...view.up), new THREE.Vector3(...view.back))
      .setPosition(...eyeOf(view));
    camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
    if (parallel === null) {
      camera.projectionMatrix.makePerspective(-right, right, top, -top, near, far);
    } else {
      camera.projectionMatrix.makeOrthographic(-right, right, top, -top, near, far);
    }
    // the window stays at the target where the eye stands beside its middle
    camera.projectionMatrix.multiply(new THREE.Matrix4().makeShear(0, 0, 0, 0, -(view.aside ?? 0), 0));
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  }
}
