/**
 * Draws the scan: holds what `shaders/march/march.frag` needs and keeps it in step with the scan,
 * its appearance and the camera. Frame: the grid's axes, lengths in mm.
 */
import type * as THREE from "three";
import { column } from "../../core/geometry/affine";
import { brickEdge, type BrickRanges } from "../../core/scan/bricks";
import { depthOf, nearAndFar, type Camera, type Extent } from "../../core/geometry/camera";
import type { Plane } from "../../core/view/clip";
import type { Displacements } from "../../core/scan/displacements";
import { drawnBy } from "../../core/appearance/drawn_values";
import { opacityKey, type Appearance } from "../../core/appearance/appearance";
import { cornersOf } from "../../core/geometry/object_pose";
import { blends, drawsSolids, greyOf, isLit, type Blend, type Optics } from "../../core/appearance/optics";
import type { Segment } from "../../core/protocol";
import { isInHaste } from "../../core/view/quality";
import { smallestSpacing, type ScanFrame } from "../../core/scan/scan_volume";
import { mostRanges, type ShownRange } from "../../core/segments/shown_segments";
import { biasedOf, largest, physical, type Rescale } from "../../core/scan/stored_values";
import { domainOf, sample, type TransferFunction } from "../../core/appearance/transfer_function";
import { add, addScaled, dot, multiply, scale, type Vec3 } from "../../core/geometry/vector";
import type { Box } from "../../core/scan/voxel_change";
import { DisplacementTexture } from "../textures/displacement_texture";
import { EmptySpace } from "./empty_space";
import { formatDefines, type FieldFormat, type FieldTexture } from "../textures/field_texture";
import { transferTextures } from "../textures/lookup_textures";
import { LightVolume } from "./light_volume";
import { MarchProgram } from "./march_program";
import { lookFrom, marchUniforms, standAt, type FieldUniform, type MarchUniforms } from "./march_uniforms";
import type { PictureTarget } from "../base/picture_target";
import { SecondTexture, type ShownSecond } from "../textures/second_texture";
import type { SurfaceLayers } from "../textures/surface_layers";

export interface MarchQuality {
  /** Steps per smallest voxel edge. */
  readonly stepsPerVoxel: number;
  /** Starts each ray at another share of a step. */
  readonly jitter: boolean;
}

/** Segments that are no threshold: the id of each voxel, and 1 for each brick that holds any. */
export interface Labels {
  readonly texture: THREE.Data3DTexture;
  readonly bricks: Uint8Array;
}

export interface RayMarcherOptions {
  /** The CPU draws. */
  readonly software: boolean;
  /** Cells along the scan's longest edge in which light is worked out. */
  readonly lightCells: number;
}

type PlaceUniform = "nearFar" | "parallel";

/** Shift within the pixel [texels], and the number of the noise pattern. */
export type Shift = readonly [number, number, number];

export class RayMarcher {
  private readonly displacements = new DisplacementTexture();
  private readonly uniforms = { ...marchUniforms(), ...this.displacements.uniforms };
  /** The light that comes through what is drawn. */
  readonly light: LightVolume;
  /** A second scan that is shown with the first. */
  readonly second = new SecondTexture();
  private readonly program: MarchProgram;
  private frame: ScanFrame | null = null;
  private readonly empty = new EmptySpace(this.uniforms.brickTexture);
  private labelled = false;
  private mode: Blend = "shaded";
  private slab: number | null = null;
  /** From the eye to the middle of the view [mm]. */
  private distance = 1;
  private step = 1;
  private clip: readonly Plane[] = [];
  private format = "FIELD_RG8";
  /** Translucent layers of surfaces; -1 where there are no surfaces at all. */
  private layers = -1;
  /** Whether tissue may be displaced from its voxels. */
  private deforming = false;
  private withSecond = false;
  /** Of the appearance for which the light was worked out. */
  private opacity = "";

  constructor(private readonly options: RayMarcherOptions = { software: true, lightCells: 64 }) {
    // the same whatever stands for surfaces while the view moves
    this.light = new LightVolume({ ...this.uniforms, bodies: { value: 0 } }, options.lightCells);
    this.program = new MarchProgram({ ...this.uniforms, ...this.light.uniforms, ...this.second.uniforms });
  }

  /**
   * Has the GPU ready, before there is a scan, a light program for what is drawn most often: to make the whole one
   * takes longer than the scan is on its way.
   *
   * @param target of the kind that pictures are drawn into.
   */
  async prepare(renderer: THREE.WebGLRenderer, target: PictureTarget, format: FieldFormat): Promise<void> {
    this.format = formatDefines[format];
    this.second.format = format;
    this.compile();
    await this.program.prepareFirst(renderer, target);
  }

  /** Pictures show all that there is to see; else more roughly, until `complete`. */
  get isWhole(): boolean {
    return this.program.isWhole;
  }

  /** Has the GPU make what pictures are whole with, while it goes on drawing. */
  async complete(renderer: THREE.WebGLRenderer, target: PictureTarget): Promise<void> {
    await this.program.complete(renderer, target);
  }

  /** Shows another scan, or the same more finely: then the light stays until what is drawn changes. */
  setField(field: FieldTexture, bricks: BrickRanges): void {
    const { frame, step } = field.volume;
    const u = this.uniforms;
    this.empty.setBricks(bricks);
    this.step = step;
    u.fieldTexture.value = field.texture;
    standAt(u, field.volume);
    if (frame !== this.frame) {
      this.setFrame(frame, field);
    }
  }

  /** The scan is as before, but for values in these bricks. */
  setBricks(bricks: BrickRanges): void {
    this.empty.setBricks(bricks);
  }

  private setFrame(frame: ScanFrame, field: FieldTexture): void {
    this.frame = frame;
    this.light.setFrame(frame);
    this.format = formatDefines[field.format];
    this.second.format = field.format;
    this.second.stand(frame);
    this.setClip(this.clip);
    this.compile();
  }

  /** Shows the scan in another way. */
  setAppearance(appearance: Appearance): void {
    if (this.frame === null) {
      return;
    }
    const u = this.uniforms;
    const { rescale } = this.frame;
    const { optics } = appearance;
    this.setTransferFunction(appearance.transferFunction, rescale);
    const { ambient, diffuse, specular, shininess, edges } = appearance.lighting;
    u.edge.value.set(appearance.edgeGradient, 1 - edges);
    u.material.value.set(ambient, diffuse, specular, shininess);
    u.density.value = optics.density;
    u.grey.value.set(...greyScale(optics, rescale));
    u.tissueFrom.value = greyOf(optics.tissueFrom, optics.window);
    u.isoColour.value.set(...sample(appearance.transferFunction.points, optics.isoValue).colour);

    const { occlusion, shadow } = appearance.lighting;
    const lit = this.light.isUsed;
    this.light.use(isLit(optics.blend) ? occlusion : 0, isLit(optics.blend) ? shadow : 0);
    const ranges = appearance.ranges.slice(0, mostRanges);
    u.rangeCount.value = ranges.length;
    ranges.forEach((range, i) => {
      u.rangeBounds.value[i]?.set(range.low, range.high, drawnAs(range), range.label);
      u.rangeColours.value[i]?.set(...range.colour);
      u.rangeMaterials.value[i]?.set(...(range.material ?? [1, 1]), range.body ?? 0);
    });
    this.empty.setDrawn(drawnBy(appearance, rescale));
    this.second.setBlend(optics.blend);
    this.slab = optics.slab;
    this.setSlab();
    if (optics.blend !== this.mode || lit !== this.light.isUsed) {
      this.mode = optics.blend;
      this.compile();
    }
    const opacity = opacityKey(appearance);
    if (opacity !== this.opacity) {
      this.opacity = opacity;
      this.light.changed();
    }
  }

  /** Shows a second scan with the first, or shows it in another way or elsewhere; null shows none. */
  setSecond(shown: ShownSecond | null): void {
    this.second.set(shown);
    this.follow();
  }

  /** Sends some of the second scan; true where it is drawn from now on. */
  uploadSecond(renderer: THREE.WebGLRenderer): boolean {
    const arrived = this.second.upload(renderer);
    if (arrived) {
      this.follow();
    }
    return arrived;
  }

  private follow(): void {
    if (this.frame !== null) {
      this.second.stand(this.frame);
    }
    if (this.second.inView !== this.withSecond) {
      this.withSecond = this.second.inView;
      this.compile();
    }
  }

  /** Shows the voxels of segments that are no threshold; null where there are none. */
  setLabels(labels: Labels | null): void {
    this.uniforms.labelTexture.value = labels?.texture ?? null;
    this.labelled = labels !== null;
    this.compile();
    this.empty.setLabelled(labels?.bricks ?? null);
    this.light.changed();
  }

  /** Colour of each label, as `labelColours` makes it. */
  setLabelColours(colours: THREE.Texture): void {
    this.uniforms.labelColours.value = colours;
    this.light.changed();
  }

  /** Values or labels of a box have changed, their bricks with them; all that follows is uploaded. */
  changeVoxels(box: Box, renderer: THREE.WebGLRenderer): void {
    this.empty.change(box, renderer);
    // interpolation and gradients reach a voxel or two beyond
    this.light.changed([(box.low[2] - 2) * this.step, (box.high[2] + 2) * this.step]);
  }

  /**
   * Whether a model of deformation is at work: then shaders look for displacements, else they
   * know of none.
   */
  setDeforming(deforming: boolean): void {
    if (deforming !== this.deforming) {
      this.deforming = deforming;
      this.compile();
    }
  }

  /** Displacements of tissue from its voxels, which add up; none where all stands in them. */
  setDisplaced(displaced: readonly Displacements[]): void {
    this.displacements.set(displaced);
    this.light.changed();
  }

  /** Cuts away what lies before planes of the scene. */
  setClip(planes: readonly Plane[]): void {
    this.clip = planes;
    if (this.frame === null) {
      return;
    }
    const { axes, sceneFromGrid, spacing } = this.frame;
    const u = this.uniforms;
    u.clipCount.value = planes.length;
    planes.forEach(({ normal, offset }, i) => {
      const inGrid = multiply([dot(normal, axes[0]), dot(normal, axes[1]), dot(normal, axes[2])], spacing);
      u.clipPlanes.value[i]?.set(...inGrid, dot(normal, column(sceneFromGrid, 3)) - offset);
    });
    this.light.changed();
  }

  setCamera(camera: Camera, extent: Extent, aspect: number): void {
    if (this.frame === null) {
      return;
    }
    const u = this.uniforms;
    lookFrom(u, this.frame, camera, aspect);
    this.light.turnKey(u.keyDirection.value);
    const { near, far } = nearAndFar(camera, extent);
    u.nearFar.value.set(near, far);
    u.parallel.value = camera.parallel === null ? 0 : 1;
    this.distance = depthOf(camera, camera.target);
    u.middleDepth.value = this.distance;
    this.setSlab();
  }

  /** Surfaces of triangles that stand in the picture; null where there are none. */
  setSurfaces(surfaces: SurfaceLayers | null): void {
    const u = this.uniforms;
    u.surfaceColour.value = surfaces?.opaque.target.texture ?? null;
    u.surfaceDepth.value = surfaces?.opaque.target.depthTexture ?? null;
    u.layerColour.value = surfaces?.translucent.map(({ target }) => target.texture) ?? [];
    u.layerDepth.value = surfaces?.translucent.flatMap(({ target }) => target.depthTexture ?? []) ?? [];
    const layers = surfaces?.translucent.length ?? -1;
    if (layers !== this.layers) {
      this.layers = layers;
      this.compile();
    }
  }

  /**
   * Corners of a box that holds all that is drawn of the scan; scene [mm]. Null where something may be drawn anywhere.
   */
  get outline(): readonly Vec3[] | null {
    const { empty, frame, deforming, step, withSecond } = this;
    const { bounds } = empty;
    if (frame === null || bounds === null || deforming || withSecond) {
      return null;
    }
    // as `standAt` places bricks; with a voxel around them, by which smooth surfaces leave theirs at most
    const low = addScaled([-step, -step, -step], bounds.low, brickEdge * step);
    const high = addScaled([step, step, step], add(bounds.high, [1, 1, 1]), brickEdge * step);
    return cornersOf({ bounds: [low, high], grid: null }, frame.sceneFromGrid);
  }

  /** Corners of a box of voxels, as `changeVoxels` is given it, with all that its values reach; scene [mm]. */
  cornersOf({ low, high }: Box): readonly Vec3[] {
    const { frame, step } = this;
    const reach: Vec3 = [2 * step, 2 * step, 2 * step];
    const bounds = [addScaled(scale(reach, -1), low, step), addScaled(reach, high, step)] as const;
    return frame === null ? [] : cornersOf({ bounds, grid: null }, frame.sceneFromGrid);
  }

  /**
   * Has bodies of voxels stand for surfaces that have them, or triangles again.
   *
   * @param opacities of these bodies; none where there are triangles.
   * @param depth how often a ray goes through those that are translucent, at most.
   */
  setBodies(opacities: readonly number[], depth: number): void {
    this.uniforms.bodies.value = opacities.length > 0 ? 1 : 0;
    this.uniforms.mostShells.value = opacities.some((opacity) => opacity < 1) ? depth : 0;
  }

  /** Whether the body of a segment that has one is drawn, where bodies stand for surfaces. */
  canEmbody(segment: Segment): boolean {
    const isTold = segment.range !== null || this.labelled;
    // between cells of a second scan its own body would be cut as the scan is
    return isTold && drawsSolids(this.mode) && !this.withSecond;
  }

  /** What other shaders need to read the scan as this one does (`field.glsl`). */
  get fieldUniforms(): Pick<MarchUniforms, FieldUniform> & LightVolume["uniforms"] {
    return { ...this.uniforms, ...this.light.uniforms };
  }

  get fieldDefines(): Readonly<Record<string, string>> {
    return {
      [this.format]: "",
      ...(!this.labelled ? {} : { LABELS: "" }),
      ...(this.deforming ? { DISPLACED: "" } : {}),
    };
  }

  /** Where near and far stand for what else draws the scan. */
  get placeUniforms(): Pick<MarchUniforms, PlaceUniform> {
    return this.uniforms;
  }

  /** Which textures are read beside those of surfaces. */
  get textureDefines(): Readonly<Record<string, string>> {
    return { ...this.surfaceDefines, ...(this.withSecond ? { SECOND: "" } : {}) };
  }

  /** The same for surfaces of triangles, which are lit as what this one draws. */
  get surfaceDefines(): Readonly<Record<string, string>> {
    // as it is most often, as long as there is none
    const lit = this.frame === null || this.light.isUsed;
    return { ...this.fieldDefines, ...(lit ? { LIGHT_VOLUME: "" } : {}) };
  }

  /** Draws rows of a level of the picture. */
  draw(renderer: THREE.WebGLRenderer, target: PictureTarget, quality: MarchQuality, shift: Shift): void {
    if (this.frame === null) {
      return;
    }
    const u = this.uniforms;
    const { x, y, width, height } = target.tile ?? { width: target.width, height: target.height, x: 0, y: 0 };
    u.pictureSize.value.set(width, height);
    u.stepLength.value = (smallestSpacing(this.frame) * this.step) / quality.stepsPerVoxel;
    u.haste.value = isInHaste(quality.stepsPerVoxel) ? 1 : 0;
    u.jitter.value = quality.jitter ? 1 : 0;
    u.shift.value.set(x + shift[0], y + shift[1], shift[2]);
    this.program.draw(renderer, target);
  }

  /** Share with which the next drawing is blended over what the target holds; null replaces it. */
  set blend(share: number | null) {
    this.program.blend = share;
  }

  dispose(): void {
    this.uniforms.transferTexture.value?.dispose();
    this.uniforms.integralTexture.value?.dispose();
    this.empty.dispose();
    this.light.dispose();
    this.second.dispose();
    this.displacements.dispose();
    this.program.dispose();
  }

  /** Chooses the shader's variant. */
  private compile(): void {
    this.program.choose(this.variant, this.lightVariant);
    this.light.compile({ ...this.fieldDefines, ...this.blendDefine });
  }

  private get variant(): Record<string, string> {
    const surfaces = this.layers < 0 ? { LAYERS: "0" } : { SURFACES: "", LAYERS: String(this.layers) };
    return {
      ...this.textureDefines,
      ...surfaces,
      ...this.blendDefine,
      ...(this.options.software ? { CPU_DRAWS: "" } : {}),
    };
  }

  /** A scan alone is shown by a light program too, in the modes that are used most. */
  private get lightVariant(): Record<string, string> | null {
    const alone = this.layers < 0 && !this.labelled && !this.deforming && !this.withSecond;
    const simple = alone && (this.mode === "shaded" || this.mode === "composite");
    return simple ? { [this.format]: "", LAYERS: "0", FIRST: "", ...this.blendDefine } : null;
  }

  private get blendDefine(): Readonly<Record<string, string>> {
    return { BLEND: String(blends.indexOf(this.mode)) };
  }

  private setTransferFunction(transferFunction: TransferFunction, rescale: Rescale): void {
    const u = this.uniforms;
    u.transferTexture.value?.dispose();
    u.integralTexture.value?.dispose();
    const { values, integrals, ends } = transferTextures(transferFunction);
    u.transferTexture.value = values;
    u.integralTexture.value = integrals;
    u.transferEnds.value = ends;
    const [low = 0, high = 1] = domainOf(transferFunction).map((value) => biasedOf(value, rescale));
    u.transferScale.value.set(1 / (high - low), -low / (high - low));
  }

  private setSlab(): void {
    const { distance, slab } = this;
    this.uniforms.slab.value.set(slab === null ? 0 : distance - slab / 2, slab === null ? 1e9 : distance + slab / 2);
  }
}

/** How a range is drawn, as `shaders/scan/segments.glsl` has it. */
function drawnAs({ visible, tinted, surface }: ShownRange): number {
  if (visible) {
    return tinted === true ? 1 : 2;
  }
  return -(surface ?? 0);
}

/** Grey per biased value and grey at 0; of the iso-surface, above 0 where it encloses. */
function greyScale(optics: Optics, rescale: Rescale): readonly [number, number] {
  const grey = (biased: number): number => {
    const value = physical(biased, rescale);
    return optics.blend === "iso" ? value - optics.isoValue : greyOf(value, optics.window);
  };
  return [(grey(largest) - grey(0)) / largest, grey(0)];
}
