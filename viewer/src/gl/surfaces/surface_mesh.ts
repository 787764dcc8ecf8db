/**
 * The surface of one segment on the GPU: a mesh for each patch, so that a patch is exchanged
 * without touching others.
 */
import * as THREE from "three";
import { columnMajor, linearColumnMajor, type Affine } from "../../core/geometry/affine";
import { CoarseSurface } from "../../core/surfaces/coarse_surface";
import { linearFromSrgb } from "../../core/base/colour";
import type { Detail } from "../../core/view/draw_budget";
import type { Segment } from "../../core/protocol";
import type { ScanFrame } from "../../core/scan/scan_volume";
import { biasedRange } from "../../core/scan/stored_values";
import type { Patch, SurfaceChange } from "../../core/surfaces/surface_patches";
import { PatchMesh, upload, type Tally } from "./patch_mesh";
import { shaders } from "../shaders/shaders";

/**
 * How long a patch that an edit has changed is drawn with all its triangles [ms]: what a tool does is seen as it is.
 */
const fineAfterEdit = 2000;

/** Triangles that a surface is drawn with however little time there is: what is small is not to vanish. */
const fewEnough = 2000;

const nowhere: Affine = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];

export class SurfaceMesh {
  /** Stands where the segment stands. */
  readonly group = new THREE.Group();
  private readonly meshes = new Map<string, PatchMesh>();
  private readonly patches = new THREE.Group();
  /** All of it with few triangles, as long as nothing is edited. */
  private coarse: PatchMesh | null = null;
  private making: CoarseSurface | null = null;
  /** When an edit changed it [ms]. */
  private changed = -Infinity;
  private readonly own = {
    colour: { value: new THREE.Vector3() },
    opacity: { value: 1 },
    factors: { value: new THREE.Vector2(1, 1) },
    bare: { value: 0 },
    ownRange: { value: new THREE.Vector2(1, 0) },
    ownLabel: { value: 0 },
    displaceable: { value: 0 },
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
    this.patches.matrixAutoUpdate = false;
    this.group.add(this.patches);
  }

  get translucent(): boolean {
    return this.own.opacity.value < 1;
  }

  get empty(): boolean {
    return this.meshes.size === 0;
  }

  /** Exchanges patches and sends the new ones to the GPU at once. */
  apply(renderer: THREE.WebGLRenderer, { whole, dropped, patches }: SurfaceChange): void {
    // a surface may come in several parts: what has its place for the first time is no edit
    const isEdit = !whole && (dropped.length > 0 || patches.some(({ key }) => this.meshes.has(key)));
    const changed = isEdit ? performance.now() : -Infinity;
    this.changed = whole ? -Infinity : Math.max(this.changed, changed);
    this.dropCoarse();
    for (const key of whole ? [...this.meshes.keys()] : dropped) {
      this.drop(key);
    }
    const added = patches.flatMap((patch) => {
      this.drop(patch.key);
      return patch.triangles.length > 0 ? [this.add(patch, changed)] : [];
    });
    if (added.length > 0) {
      upload(renderer, added);
      this.patches.add(...added.map(({ mesh }) => mesh));
    }
  }

  /** Makes the next of its few triangles; false where there are none to be made. */
  prepareNext(): boolean {
    if (this.material.wireframe || this.triangles <= fewEnough) {
      return false;
    }
    return this.isEdited ? this.prepareNextPatch() : this.prepareCoarse();
  }

  /** Triangles of patches that a camera has in view. */
  trianglesIn(camera: THREE.Camera): number {
    const view = new THREE.Frustum().setFromProjectionMatrix(
      camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse),
    );
    return [...this.meshes.values()].reduce(
      (sum, { mesh, triangles }) => sum + (view.intersectsObject(mesh) ? triangles : 0),
      0,
    );
  }

  /** Draws all triangles from now on, or of what is no wireframe the few that are there. */
  use(detail: Detail): void {
    const wanted = this.material.wireframe ? "all" : detail;
    const isCoarse = wanted === "few" && this.coarse !== null;
    this.patches.visible = !isCoarse;
    if (this.coarse !== null) {
      this.coarse.mesh.visible = isCoarse;
    }
    for (const patch of this.meshes.values()) {
      patch.use(wanted);
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
    const range =
      segment.range === null ? ([1, 0] as const) : biasedRange(segment.range[0], segment.range[1], frame.rescale);
    own.ownRange.value.set(...range);
    own.displaceable.value = segment.pose === null && segment.grid === null ? 1 : 0;
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
    this.dropCoarse();
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

  private get triangles(): number {
    return [...this.meshes.values()].reduce((sum, { triangles }) => sum + triangles, 0);
  }

  private get isEdited(): boolean {
    return performance.now() - this.changed <= fineAfterEdit;
  }

  /** Makes the few triangles of a patch that was not edited just now. */
  private prepareNextPatch(): boolean {
    const now = performance.now();
    const next = [...this.meshes.values()].find((patch) => !patch.isPrepared && now - patch.changed > fineAfterEdit);
    next?.prepare();
    return next !== undefined;
  }

  /** Takes the next patch into the surface with few triangles. */
  private prepareCoarse(): boolean {
    if (this.coarse !== null) {
      return false;
    }
    this.making ??= new CoarseSurface([...this.meshes.values()].map(({ patch }) => patch));
    this.making.takeNext();
    if (this.making.isWhole) {
      this.coarse = this.drawnInstead(this.making.patch);
      this.making = null;
      this.group.add(this.coarse.mesh);
    }
    return true;
  }

  /** A mesh of all of the surface, counted as the patches that it is drawn for. */
  private drawnInstead(patch: Patch): PatchMesh {
    const coarse = new PatchMesh(patch, -Infinity, this.material, this.tally);
    coarse.mesh.onBeforeRender = (_renderer, _scene, camera) => {
      this.tally.drawn += coarse.triangles;
      this.tally.all += this.trianglesIn(camera);
    };
    return coarse;
  }

  private dropCoarse(): void {
    this.making = null;
    if (this.coarse !== null) {
      this.group.remove(this.coarse.mesh);
      this.coarse.dispose();
      this.coarse = null;
    }
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
      this.patches.remove(patch.mesh);
      this.meshes.delete(key);
    }
  }
}
