/**
 * Surfaces of segments, drawn from their patches into layers that the ray caster reads, so
 * that scan and surfaces hide one another as they should. Opaque ones first, with their
 * depth; then the translucent ones, a layer at a time from near to far.
 */
import * as THREE from "three";
import { columnMajor } from "../../core/geometry/affine";
import { eyeOf, sightOf, type Camera } from "../../core/geometry/camera";
import { mostPlanes, type Plane } from "../../core/view/clip";
import type { Detail } from "../../core/view/draw_budget";
import type { MovedPose, Segment } from "../../core/protocol";
import { isInHaste } from "../../core/view/quality";
import type { ScanFrame } from "../../core/scan/scan_volume";
import { bodyOpacity, drawnAsSurface, withoutRoom, type InsideModes } from "../../core/segments/shown_segments";
import type { SurfaceChange } from "../../core/surfaces/surface_patches";
import { keyLight } from "../march/key_light";
import type { Tally } from "./patch_mesh";
import type { RayMarcher, Shift } from "../march/ray_marcher";
import type { PictureTarget } from "../base/picture_target";
import { layersWithin, SurfaceLayers } from "../textures/surface_layers";
import { SurfaceMesh } from "./surface_mesh";

export interface SurfaceDrawing {
  /** Of the picture's resolution. */
  readonly divisor: number;
  /** Of the rays, per smallest voxel edge. */
  readonly stepsPerVoxel: number;
  readonly shift: Shift;
  /** Translucent layers behind one another that are drawn, at most. */
  readonly depth: number;
  /** With few triangles, bodies of voxels stand for surfaces that have them. */
  readonly detail: Detail;
}

export class Surfaces {
  private readonly scene = new THREE.Scene();
  private readonly meshes = new Map<number, SurfaceMesh>();
  private readonly layers: SurfaceLayers;
  private readonly camera = new THREE.Camera();
  private readonly shared;
  private segments: readonly Segment[] = [];
  private modes: InsideModes = {};
  private frame: ScanFrame | null = null;
  private poses: readonly MovedPose[] = [];
  private readonly tally: Tally = { drawn: 0, all: 0 };

  constructor(
    private readonly marcher: RayMarcher,
    halfFloat: boolean,
  ) {
    this.layers = new SurfaceLayers(halfFloat);
    this.shared = {
      ...marcher.fieldUniforms,
      gridFromScene: { value: new THREE.Matrix4() },
      eye: { value: new THREE.Vector4() },
      keyDirection: { value: new THREE.Vector3() },
      upDirection: { value: new THREE.Vector3() },
      clipPlanes: { value: Array.from({ length: mostPlanes }, () => new THREE.Vector4()) },
      clipCount: { value: 0 },
      sceneFromCube: { value: new THREE.Matrix4() },
      layerSize: { value: new THREE.Vector2() },
      haste: { value: 0 },
      peeled: { value: 0 },
      depthBefore: { value: null as THREE.Texture | null },
      depthOpaque: { value: null as THREE.Texture | null },
    };
    this.scene.matrixWorldAutoUpdate = true;
    this.camera.matrixAutoUpdate = false;
    this.camera.matrixWorldAutoUpdate = false;
  }

  setFrame(frame: ScanFrame): void {
    this.frame = frame;
    this.shared.gridFromScene.value.fromArray(columnMajor(frame.gridFromScene));
    this.setSegments(this.segments, this.modes);
  }

  /** Takes what an edit changes and sends it to the GPU; drawn from the next picture on. */
  apply(renderer: THREE.WebGLRenderer, changes: readonly SurfaceChange[]): void {
    for (const change of changes) {
      const mesh = this.meshes.get(change.id) ?? new SurfaceMesh(this.shared, this.tally);
      this.meshes.set(change.id, mesh);
      this.scene.add(mesh.group);
      mesh.compile(this.defines);
      mesh.apply(renderer, change);
      if (mesh.empty) {
        this.forget(change.id);
      }
    }
    this.setSegments(this.segments, this.modes);
  }

  /** @param modes how voxels are drawn beside surfaces. */
  setSegments(segments: readonly Segment[], modes: InsideModes): void {
    this.segments = segments;
    this.modes = modes;
    for (const segment of segments) {
      if (this.frame !== null) {
        this.meshes.get(segment.id)?.setSegment(this.standing(segment), this.frame);
      }
    }
  }

  /** Puts moved segments where they stand now; false where they stand there already. */
  setPoses(poses: readonly MovedPose[]): boolean {
    if (samePoses(poses, this.poses)) {
      return false;
    }
    this.poses = poses;
    for (const { id, pose } of poses) {
      if (this.frame !== null) {
        this.meshes.get(id)?.stand(pose, this.frame);
      }
    }
    return true;
  }

  /** Cuts away what lies before planes. */
  setClip(planes: readonly Plane[]): void {
    const { clipPlanes, clipCount } = this.shared;
    clipCount.value = planes.length;
    planes.forEach(({ normal, offset }, i) => clipPlanes.value[i]?.set(...normal, -offset));
  }

  setCamera(view: Camera, camera: THREE.Camera): void {
    this.camera.matrixWorld.copy(camera.matrixWorld);
    this.camera.matrixWorldInverse.copy(camera.matrixWorldInverse);
    this.camera.projectionMatrix.copy(camera.projectionMatrix);
    const { eye, keyDirection, upDirection } = this.shared;
    eye.value.set(...(view.parallel === null ? eyeOf(view) : sightOf(view)), view.parallel === null ? 1 : 0);
    keyDirection.value.set(...keyLight(view));
    upDirection.value.set(...view.up);
  }

  /**
   * Whether surfaces are drawn that may stand elsewhere than the voxels of their segments, or where nothing tells of
   * these.
   */
  get stray(): boolean {
    return this.parted.others.length > 0;
  }

  /**
   * Makes the few triangles of surfaces that have none yet and no body either, as long as `milliseconds` are not over.
   */
  prepareFew(milliseconds: number): void {
    const ends = performance.now() + milliseconds;
    for (const mesh of this.parted.others) {
      let isMaking = true;
      while (isMaking && performance.now() < ends) {
        isMaking = mesh.prepareNext();
      }
    }
  }

  /**
   * Draws all surfaces for a level of the picture and hands them to the ray caster; tells what they had of triangles.
   */
  draw(
    renderer: THREE.WebGLRenderer,
    picture: PictureTarget,
    { divisor, stepsPerVoxel, shift, depth, detail }: SurfaceDrawing,
  ): Readonly<Tally> {
    const { bodies, others } = this.parted;
    const embodied = detail === "few" ? [...bodies.keys()] : [];
    const shown = detail === "few" ? others : [...bodies.keys(), ...others];
    this.marcher.setBodies(detail === "few" ? [...bodies.values()] : [], depth);
    Object.assign(this.tally, { drawn: 0, all: 0 });
    if (bodies.size + others.length === 0) {
      this.marcher.setSurfaces(null);
      return { ...this.tally };
    }
    const { layers, shared } = this;
    const translucent = shown.filter((mesh) => mesh.translucent);
    const room = layersWithin(renderer.capabilities.maxTextures, this.marcher.textureDefines);
    layers.use(picture.target, divisor, translucent.length > 0 ? Math.min(depth, room) : 0);
    for (const mesh of shown) {
      mesh.compile(this.defines);
      mesh.use(detail);
    }
    const camera = shifted(this.camera, picture, shift);
    shared.sceneFromCube.value.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).invert();
    shared.haste.value = isInHaste(stepsPerVoxel) ? 1 : 0;
    shared.layerSize.value.set(layers.opaque.width, layers.opaque.height);
    this.drawLayer(
      renderer,
      layers.opaque,
      camera,
      shown.filter((mesh) => !mesh.translucent),
    );
    shared.depthOpaque.value = layers.opaque.target.depthTexture;
    shared.peeled.value = 0;
    for (const layer of layers.translucent) {
      this.drawLayer(renderer, layer, camera, translucent);
      shared.depthBefore.value = layer.target.depthTexture;
      shared.peeled.value = 1;
    }
    this.marcher.setSurfaces(layers);
    this.tally.all += embodied.reduce((sum, mesh) => sum + mesh.trianglesIn(camera), 0);
    return { ...this.tally };
  }

  dispose(): void {
    for (const id of [...this.meshes.keys()]) {
      this.forget(id);
    }
    this.layers.dispose();
  }

  private get defines(): Readonly<Record<string, string>> {
    return { ...this.marcher.surfaceDefines, ...(this.shared.clipCount.value > 0 ? { CLIPPED: "" } : {}) };
  }

  /**
   * The surfaces that are shown: those for which bodies of voxels can stand, with the opacity of each, and all others.
   */
  private get parted(): { readonly bodies: ReadonlyMap<SurfaceMesh, number>; readonly others: readonly SurfaceMesh[] } {
    const [bodies, others] = [new Map<SurfaceMesh, number>(), [] as SurfaceMesh[]];
    const without = withoutRoom(this.segments);
    for (const segment of this.segments.filter(drawnAsSurface)) {
      const mesh = this.meshes.get(segment.id);
      const opacity = without.includes(segment) ? 0 : bodyOpacity(this.standing(segment), this.modes[segment.id]);
      if (mesh !== undefined && opacity > 0 && this.marcher.canEmbody(segment)) {
        bodies.set(mesh, opacity);
      } else if (mesh !== undefined) {
        others.push(mesh);
      }
    }
    return { bodies, others };
  }

  /** A segment where it stands now; its list has where it was asked to go. */
  private standing(segment: Segment): Segment {
    const moved = this.poses.find(({ id }) => id === segment.id);
    return moved === undefined ? segment : { ...segment, pose: moved.pose };
  }

  private drawLayer(
    renderer: THREE.WebGLRenderer,
    layer: PictureTarget,
    camera: THREE.Camera,
    drawn: readonly SurfaceMesh[],
  ): void {
    for (const mesh of this.meshes.values()) {
      mesh.group.visible = drawn.includes(mesh);
    }
    renderer.setRenderTarget(layer.target);
    renderer.setClearColor(0x000000, 0);
    renderer.clear(true, true, false);
    renderer.render(this.scene, camera);
  }

  private forget(id: number): void {
    const mesh = this.meshes.get(id);
    if (mesh !== undefined) {
      this.scene.remove(mesh.group);
      mesh.dispose();
      this.meshes.delete(id);
    }
  }
}

function samePoses(a: readonly MovedPose[], b: readonly MovedPose[]): boolean {
  const same = (one: MovedPose, other: MovedPose | undefined): boolean =>
    one.id === other?.id && one.pose.every((number, place) => number === other.pose[place]);
  return a.length === b.length && a.every((moved, place) => same(moved, b[place]));
}

/** The camera for a picture that is shifted within its pixels, or a tile, as the ray caster shifts its rays. */
export function shifted(camera: THREE.Camera, { width, height, tile }: PictureTarget, [x, y]: Shift): THREE.Camera {
  const moved = camera.clone();
  moved.matrixWorld.copy(camera.matrixWorld);
  moved.matrixWorldInverse.copy(camera.matrixWorldInverse);
  const whole = tile ?? { width, height, x: 0, y: 0 };
  const [sx, sy] = [whole.width / width, whole.height / height];
  const part = new THREE.Matrix4().makeScale(sx, sy, 1);
  part.setPosition(sx - 1 - (2 * (whole.x + x)) / width, sy - 1 - (2 * (whole.y + y)) / height, 0);
  moved.projectionMatrix.premultiply(part);
  return moved;
}
