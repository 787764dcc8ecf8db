/**
 * A patch of a surface on the GPU: its vertices as they arrived (shares of the patch's box), and which triangles are
 * drawn over them, all or those that are left for pictures in haste. The few are made when they are asked for.
 */
import * as THREE from "three";
import { coarseTriangles } from "../../core/surfaces/coarse_triangles";
import type { Detail } from "../../core/view/draw_budget";
import type { Patch } from "../../core/surfaces/surface_patches";

/** Triangles of what is in view. */
export interface Tally {
  /** That were drawn. */
  drawn: number;
  /** That would have been drawn, were none left out. */
  all: number;
}

/** The ball around the unit cube, in which every patch's vertices lie. */
const unitBall = new THREE.Sphere(new THREE.Vector3(0.5, 0.5, 0.5), Math.sqrt(3) / 2);

export class PatchMesh {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>;
  private readonly all: THREE.BufferGeometry;
  private few: THREE.BufferGeometry | null = null;

  /**
   * @param changed when an edit changed it [ms], or -Infinity.
   * @param tally counts what is drawn of it.
   */
  constructor(
    readonly patch: Patch,
    readonly changed: number,
    material: THREE.RawShaderMaterial,
    tally: Tally,
  ) {
    this.all = new THREE.BufferGeometry();
    this.all.setAttribute("position", new THREE.BufferAttribute(patch.vertices, 3, true));
    this.all.setAttribute("normal", new THREE.BufferAttribute(patch.normals, 4, true));
    this.all.setIndex(new THREE.BufferAttribute(patch.triangles, 1));
    this.all.boundingSphere = unitBall;
    this.mesh = new THREE.Mesh(this.all, material);
    this.mesh.matrixAutoUpdate = false;
    const [sx, sy, sz] = patch.size;
    this.mesh.matrix.makeScale(sx, sy, sz).setPosition(...patch.origin);
    this.mesh.onBeforeRender = () => {
      tally.drawn += trianglesOf(this.mesh.geometry);
      tally.all += trianglesOf(this.all);
    };
  }

  /** All that it has. */
  get triangles(): number {
    return trianglesOf(this.all);
  }

  /** Whether the few triangles are there. */
  get isPrepared(): boolean {
    return this.few !== null;
  }

  prepare(): void {
    const { all, patch } = this;
    this.few = new THREE.BufferGeometry();
    for (const [name, attribute] of Object.entries(all.attributes)) {
      this.few.setAttribute(name, attribute);
    }
    this.few.setIndex(new THREE.BufferAttribute(coarseTriangles(patch), 1));
    this.few.boundingSphere = unitBall;
  }

  /** Draws all triangles from now on, or the few where they are there. */
  use(detail: Detail): void {
    this.mesh.geometry = detail === "few" ? (this.few ?? this.all) : this.all;
  }

  dispose(): void {
    this.all.dispose();
    this.few?.dispose();
  }
}

/** Sends patches to the GPU before they are seen: three.js does so for what it draws, here no triangles. */
export function upload(renderer: THREE.WebGLRenderer, patches: readonly PatchMesh[]): void {
  const scene = new THREE.Scene();
  scene.add(...patches.map(({ mesh }) => mesh));
  for (const { mesh } of patches) {
    mesh.frustumCulled = false;
    mesh.geometry.setDrawRange(0, 0);
  }
  renderer.render(scene, new THREE.Camera());
  for (const { mesh } of patches) {
    mesh.frustumCulled = true;
    mesh.geometry.setDrawRange(0, Infinity);
  }
}

function trianglesOf({ index }: THREE.BufferGeometry): number {
  return (index?.count ?? 0) / 3;
}
