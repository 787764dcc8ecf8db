/**
 * The surface of one segment on the GPU: a mesh for each patch, with its vertices as they
 * arrived (shares of the patch's box), so that a patch is exchanged without touching others.
 */
import * as THREE from "three";
import { columnMajor, linearColumnMajor, type Affine } from "../core/affine";
import { linearFromSrgb } from "../core/colour";
import type { Segment } from "../core/protocol";
import type { ScanFrame } from "../core/scan_volume";
import { biasedRange } from "../core/stored_values";
import type { Patch, SurfaceChange } from "../core/surface_patches";
import { shaders } from "./shaders";

type PatchMesh = THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>;

/** The ball around the unit cube, in which every patch's vertices lie. */
const unitBall = new THREE.Sphere(new THREE.Vector3(0.5, 0.5, 0.5), Math.sqrt(3) / 2);

const nowhere: Affine = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];

export class SurfaceMesh {
  /** Stands where the segment stands. */
  readonly group = new THREE.Group();
  private readonly meshes = new Map<string, PatchMesh>();
  private readonly own = {
    colour: { value: new THREE.Vector3() },
    opacity: { value: 1 },
    factors: { value: new THREE.Vector2(1, 1) },
    bare: { value: 0 },
    ownRange: { value: new THREE.Vector2(1, 0) },
    ownLabel: { value: 0 },
    gives: { value: 0 },
    gridFromPosed: { value: new THREE.Matrix4() },
    posedFromGrid: { value: new THREE.Matrix4() },
    posedFromSurface: { value: new THREE.Matrix3() },
    gridAxesFromSurface: { value: new THREE.Matrix3() },
  };
  private readonly material: THREE.RawShaderMaterial;

  /** @param shared uniforms of all surfaces. */
  constructor(shared: Readonly<Record<string, THREE.IUniform>>) {
    this.material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: shaders.surface.vertex,
      fragmentShader: shaders.surface.fragment,
      uniforms: { ...shared, ...this.own },
      side: THREE.DoubleSide,
      blending: THREE.NoBlending,
    });
    this.group.matrixAutoUpdate = false;
  }

  get translucent(): boolean {
    return this.own.opacity.value < 1;
  }

  get empty(): boolean {
    return this.meshes.size === 0;
  }

  /** Exchanges patches and sends the new ones to the GPU at once. */
  apply(renderer: THREE.WebGLRenderer, { whole, dropped, patches }: SurfaceChange): void {
    for (const key of whole ? [...this.meshes.keys()] : dropped) {
      this.drop(key);
    }
    const added = patches.flatMap((patch) => {
      this.drop(patch.key);
      return patch.triangles.length > 0 ? [this.add(patch)] : [];
    });
    if (added.length > 0) {
      upload(renderer, added);
      this.group.add(...added);
    }
  }

  /** Shows the segment as the list of segments says. */
  setSegment(segment: Segment, frame: ScanFrame): void {
    const { own } = this;
    own.colour.value.set(...linearFromSrgb(segment.colour));
    own.opacity.value = segment.opacity;
    own.factors.value.set(segment.ambient, segment.specular);
    own.bare.value = segment.wireframe ? 1 : 0;
    this.material.wireframe = segment.wireframe;
    own.ownLabel.value = segment.range === null && segment.grid === null ? segment.id : 0;
    const range = segment.range === null ? ([1, 0] as const) : biasedRange(segment.range[0], segment.range[1], frame.rescale);
    own.ownRange.value.set(...range);
    own.gives.value = segment.pose === null && segment.grid === null ? 1 : 0;
    this.stand(segment.pose ?? nowhere, frame);
  }

  /** Chooses the shader's variant. */
  compile(defines: Readonly<Record<string, string>>): void {
    const wanted = { ...defines, ...(this.translucent ? { TRANSLUCENT: "" } : {}) };
    const { material } = this;
    if (Object.keys(wanted).join() !== Object.keys(material.defines ?? {}).join()) {
      material.defines = wanted;
      material.needsUpdate = true;
    }
  }

  dispose(): void {
    for (const key of [...this.meshes.keys()]) {
      this.drop(key);
    }
    this.material.dispose();
  }

  /** Puts it where its segment stands now. */
  stand(pose: readonly number[], { gridFromScene, axes }: ScanFrame): void {
    const { group, own } = this;
    group.matrix.fromArray(columnMajor(pose));
    const gridFromSurface = new THREE.Matrix4().fromArray(columnMajor(gridFromScene));
    own.gridFromPosed.value.copy(group.matrix).invert().premultiply(gridFromSurface);
    own.posedFromGrid.value.copy(own.gridFromPosed.value).invert();
    own.posedFromSurface.value.fromArray(linearColumnMajor(pose));
    const [x, y, z] = axes;
    own.gridAxesFromSurface.value.set(...x, ...y, ...z);
  }

  private add(patch: Patch): PatchMesh {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(patch.vertices, 3, true));
    geometry.setAttribute("normal", new THREE.BufferAttribute(patch.normals, 4, true));
    geometry.setIndex(new THREE.BufferAttribute(patch.triangles, 1));
    geometry.boundingSphere = unitBall;
    const mesh = new THREE.Mesh(geometry, this.material);
    mesh.matrixAutoUpdate = false;
    const [sx, sy, sz] = patch.size;
    mesh.matrix.makeScale(sx, sy, sz).setPosition(...patch.origin);
    this.meshes.set(patch.key, mesh);
    return mesh;
  }

  private drop(key: string): void {
    const mesh = this.meshes.get(key);
    if (mesh !== undefined) {
      mesh.geometry.dispose();
      this.group.remove(mesh);
      this.meshes.delete(key);
    }
  }
}

/** Sends buffers to the GPU before they are seen: three.js does so for what it draws, here no triangles. */
function upload(renderer: THREE.WebGLRenderer, meshes: readonly PatchMesh[]): void {
  const scene = new THREE.Scene();
  scene.add(...meshes);
  for (const mesh of meshes) {
    mesh.frustumCulled = false;
    mesh.geometry.setDrawRange(0, 0);
  }
  renderer.render(scene, new THREE.Camera());
  for (const mesh of meshes) {
    mesh.frustumCulled = true;
    mesh.geometry.setDrawRange(0, Infinity);
  }
}
