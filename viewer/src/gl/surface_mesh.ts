/**
 * The surface of one segment on the GPU: a mesh for each patch, so that a patch is exchanged
 * without touching others.
 */
import * as THREE from "three";
import { columnMajor, linearColumnMajor, type Affine } from "../core/affine";
import { linearFromSrgb } from "../core/colour";
import type { Detail } from "../core/pace";
import type { Segment } from "../core/protocol";
import type { ScanFrame } from "../core/scan_volume";
import { biasedRange } from "../core/stored_values";
import type { Patch, SurfaceChange } from "../core/surface_patches";
import { PatchMesh, upload, type Tally } from "./patch_mesh";
import { shaders } from "./shaders";

/** How long a patch that an edit has changed is drawn with all its triangles [ms]: what a tool does is seen as it is. */
const fineAfterEdit = 2000;

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

  /**
   * @param shared uniforms of all surfaces.
   * @param tally counts what is drawn of it.
   */
  constructor(
    shared: Readonly<Record<string, THREE.IUniform>>,
    private readonly tally: Tally,
  ) {
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
      return patch.triangles.length > 0 ? [this.add(patch, whole ? -Infinity : performance.now())] : [];
    });
    if (added.length > 0) {
      upload(renderer, added);
      this.group.add(...added.map(({ mesh }) => mesh));
    }
  }

  /** Patches whose few triangles are still to be made, without those that were edited just now. */
  get unprepared(): readonly PatchMesh[] {
    const now = performance.now();
    return [...this.meshes.values()].filter((patch) => !patch.isPrepared && now - patch.changed > fineAfterEdit);
  }

  /** Triangles of patches that a view has in it. */
  trianglesIn(view: THREE.Frustum): number {
    return [...this.meshes.values()].reduce((sum, { mesh, triangles }) => sum + (view.intersectsObject(mesh) ? triangles : 0), 0);
  }

  /** Draws all triangles from now on, or of what is no wireframe the few that are there. */
  use(detail: Detail): void {
    for (const patch of this.meshes.values()) {
      patch.use(this.material.wireframe ? "all" : detail);
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

  private add(patch: Patch, changed: number): PatchMesh {
    const mesh = new PatchMesh(patch, changed, this.material, this.tally);
    this.meshes.set(patch.key, mesh);
    return mesh;
  }

  private drop(key: string): void {
    const patch = this.meshes.get(key);
    if (patch !== undefined) {
      patch.dispose();
      this.group.remove(patch.mesh);
      this.meshes.delete(key);
    }
  }
}
