/**
 * Draws the scan: holds what `shaders/march.frag` needs and keeps it in step with the scan,
 * its look and the camera. Frame: the grid's axes, lengths in mm.
 */
import * as THREE from "three";
import { transformPoint } from "../core/affine";
import { brickEdge, distanceToFilled, filledBricks, type BrickRanges } from "../core/bricks";
import { clipPlanes, eyeOf, type Camera, type Extent } from "../core/camera";
import { DrawnValues } from "../core/drawn_values";
import { flatShare, type Look } from "../core/look";
import { smallestSpacing, type ScanFrame } from "../core/scan_volume";
import { mostRanges } from "../core/shown_segments";
import { biasedOf } from "../core/stored_values";
import { domainOf } from "../core/transfer_function";
import { add, dot, normalize, scale, type Vec3 } from "../core/vector";
import { bricksReadingBox, forEachCell, type Box } from "../core/voxel_change";
import type { FieldTexture } from "./field_texture";
import { FullscreenPass } from "./fullscreen_pass";
import { byteTexture, transferTexture } from "./lookup_textures";
import type { PictureTarget } from "./picture_target";
import { DisplacedTexture } from "./displaced_texture";
import type { Displaced } from "../core/displaced";
import { shaders } from "./shaders";
import type { SurfaceLayers } from "./surface_layers";

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

/** Shift within the pixel [texels], and the number of the noise pattern. */
export type Shift = readonly [number, number, number];

const vector = (v: Vec3 = [0, 0, 0]): THREE.Vector3 => new THREE.Vector3(...v);

function marchUniforms() {
  const many = (): THREE.Vector3[] => Array.from({ length: mostRanges }, () => vector());
  return {
    fieldTexture: { value: null as THREE.Texture | null },
    dimensions: { value: vector() },
    textureScale: { value: vector() },
    textureOffset: { value: vector() },
    sampleStep: { value: vector() },
    spacing: { value: vector() },
    slope: { value: 1 },
    rangeBounds: { value: Array.from({ length: mostRanges }, () => new THREE.Vector4()) },
    rangeColours: { value: many() },
    rangeCount: { value: 0 },
    labelTexture: { value: null as THREE.Texture | null },
    labelColours: { value: null as THREE.Texture | null },
    keyDirection: { value: vector() },
    upDirection: { value: vector() },
    pictureSize: { value: new THREE.Vector2() },
    shift: { value: vector() },
    eye: { value: vector() },
    forward: { value: vector() },
    across: { value: vector() },
    upward: { value: vector() },
    clip: { value: new THREE.Vector2() },
    stepLength: { value: 1 },
    jitter: { value: 1 },
    transferTexture: { value: null as THREE.Texture | null },
    transferScale: { value: new THREE.Vector2() },
    edge: { value: new THREE.Vector2() },
    brickTexture: { value: null as THREE.Texture | null },
    brickScale: { value: vector() },
    brickOffset: { value: vector() },
    surfaceColour: { value: null as THREE.Texture | null },
    surfaceDepth: { value: null as THREE.Texture | null },
    surfaceLead: { value: 0 },
    layerColour: { value: [] as THREE.Texture[] },
    layerDepth: { value: [] as THREE.Texture[] },
  };
}

type MarchUniforms = ReturnType<typeof marchUniforms> & DisplacedTexture["uniforms"];
type FieldUniform =
  | "fieldTexture"
  | "dimensions"
  | "textureScale"
  | "textureOffset"
  | "sampleStep"
  | "spacing"
  | "slope"
  | "labelTexture"
  | keyof DisplacedTexture["uniforms"];

export class RayMarcher {
  private readonly displacements = new DisplacedTexture();
  private readonly uniforms = { ...marchUniforms(), ...this.displacements.uniforms };
  private readonly pass = new FullscreenPass(shaders.march, this.uniforms);
  private frame: ScanFrame | null = null;
  private bricks: BrickRanges | null = null;
  private labelled: Uint8Array | null = null;
  /** Values that the look draws. */
  private drawn: DrawnValues | null = null;
  /** Bricks that hold something drawn. */
  private filled: Uint8Array | null = null;
  private step = 1;
  private format = "FIELD_RG8";
  /** Translucent layers of surfaces; -1 where there are no surfaces at all. */
  private layers = -1;
  /** Whether matter may stand beside its voxels. */
  private gives = false;

  /** Shows another scan. */
  setField(field: FieldTexture, bricks: BrickRanges): void {
    const { frame, dimensions, step } = field.volume;
    const u = this.uniforms;
    this.frame = frame;
    this.bricks = bricks;
    this.step = step;
    u.fieldTexture.value = field.texture;
    u.dimensions.value.set(...frame.dimensions);
    u.spacing.value.set(...frame.spacing);
    u.sampleStep.value.setScalar(step);
    u.slope.value = frame.rescale.slope;
    u.surfaceLead.value = smallestSpacing(frame) * step;
    // texel centres stand at half numbers: see core/scan_volume.ts
    const first = 0.5 - 0.5 / step;
    u.textureScale.value.set(...inverted(scale(dimensions, step)));
    u.textureOffset.value.set(...scale(inverted(dimensions), first));
    u.brickScale.value.setScalar(1 / (step * brickEdge));
    u.brickOffset.value.setScalar(first / brickEdge);
    this.format = { rg8: "FIELD_RG8", r16: "FIELD_R16", r32f: "FIELD_R32F" }[field.format];
    this.compile();
  }

  /** Shows the scan in another way. */
  setLook(look: Look): void {
    if (this.frame === null || this.bricks === null) {
      return;
    }
    const u = this.uniforms;
    const { rescale } = this.frame;
    u.transferTexture.value?.dispose();
    const table = transferTexture(look.transferFunction);
    u.transferTexture.value = table;
    const [low, high] = domainOf(look.transferFunction).map((value) => biasedOf(value, rescale));
    u.transferScale.value.set(...texelCoordinates(low ?? 0, high ?? 1, table.width));
    u.edge.value.set(look.edgeGradient, flatShare);

    const ranges = look.ranges.slice(0, mostRanges);
    u.rangeCount.value = ranges.length;
    ranges.forEach((range, i) => {
      u.rangeBounds.value[i]?.set(range.low, range.high, range.visible ? 1 : 0, range.label);
      u.rangeColours.value[i]?.set(...range.colour);
    });
    this.drawn = new DrawnValues(
      look.transferFunction,
      rescale,
      look.ranges.filter((range) => range.visible).map(({ low, high }) => [low, high]),
    );
    this.fillBricks();
  }

  /** Shows the voxels of segments that are no threshold; null where there are none. */
  setLabels(labels: Labels | null): void {
    this.uniforms.labelTexture.value = labels?.texture ?? null;
    this.labelled = labels?.bricks ?? null;
    this.compile();
    this.fillBricks();
  }

  /** Colour of each label, as `labelColours` makes it. */
  setLabelColours(colours: THREE.Texture): void {
    this.uniforms.labelColours.value = colours;
  }

  /** Values or labels of a box have changed, their bricks with them; all that follows is uploaded. */
  changeVoxels(box: Box, renderer: THREE.WebGLRenderer): void {
    const { bricks, drawn, filled, labelled } = this;
    if (bricks === null || drawn === null || filled === null) {
      return;
    }
    let same = true;
    forEachCell(bricksReadingBox(box, bricks.counts), bricks.counts, (i) => {
      const full = drawn.any(bricks.low[i] ?? 0, bricks.high[i] ?? 0) || labelled?.[i] === 1 ? 1 : 0;
      same &&= filled[i] === full;
      filled[i] = full;
    });
    if (!same) {
      this.measureEmptiness();
      const { value: texture } = this.uniforms.brickTexture;
      if (texture !== null) {
        renderer.initTexture(texture);
      }
    }
  }

  /**
   * Whether a model of deformation is at work: then shaders look for displacements, else they
   * know of none.
   */
  setGives(gives: boolean): void {
    if (gives !== this.gives) {
      this.gives = gives;
      this.compile();
    }
  }

  /** Where matter stands beside its voxels; null where all stands in them. */
  setDisplaced(displaced: Displaced | null): void {
    this.displacements.set(displaced);
  }

  setCamera(camera: Camera, extent: Extent, aspect: number): void {
    if (this.frame === null) {
      return;
    }
    const { axes, gridFromScene } = this.frame;
    const along = (v: Vec3): Vec3 => [dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)];
    const half = Math.tan(camera.field / 2);
    const u = this.uniforms;
    u.eye.value.set(...transformPoint(gridFromScene, eyeOf(camera)));
    u.forward.value.set(...along(scale(camera.back, -1)));
    u.across.value.set(...along(scale(camera.right, half * aspect)));
    u.upward.value.set(...along(scale(camera.up, half)));
    u.upDirection.value.set(...along(camera.up));
    u.keyDirection.value.set(...along(keyLight(camera)));
    const { near, far } = clipPlanes(camera, extent);
    u.clip.value.set(near, far);
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

  /** What other shaders need to read the scan as this one does (`field.glsl`). */
  get fieldUniforms(): Pick<MarchUniforms, FieldUniform> {
    return this.uniforms;
  }

  get fieldDefines(): Readonly<Record<string, string>> {
    return {
      [this.format]: "",
      ...(this.labelled === null ? {} : { LABELS: "" }),
      ...(this.gives ? { DISPLACED: "" } : {}),
    };
  }

  /** Draws rows of a level of the picture. */
  draw(renderer: THREE.WebGLRenderer, target: PictureTarget, quality: MarchQuality, shift: Shift): void {
    if (this.frame === null) {
      return;
    }
    const u = this.uniforms;
    u.pictureSize.value.set(target.width, target.height);
    u.stepLength.value = (smallestSpacing(this.frame) * this.step) / quality.stepsPerVoxel;
    u.jitter.value = quality.jitter ? 1 : 0;
    u.shift.value.set(...shift);
    this.pass.draw(renderer, target.target);
  }

  /** Share with which the next drawing is blended over what the target holds; null replaces it. */
  set blend(share: number | null) {
    const { material } = this.pass;
    material.blending = share === null ? THREE.NoBlending : THREE.CustomBlending;
    material.blendSrc = THREE.ConstantAlphaFactor;
    material.blendDst = THREE.OneMinusConstantAlphaFactor;
    material.blendAlpha = share ?? 1;
    // the depth stays that of the first picture
    material.depthWrite = share === null;
  }

  dispose(): void {
    this.uniforms.transferTexture.value?.dispose();
    this.uniforms.brickTexture.value?.dispose();
    this.displacements.dispose();
    this.pass.dispose();
  }

  /** Chooses the shader's variant. */
  private compile(): void {
    const { material } = this.pass;
    const surfaces = this.layers < 0 ? { LAYERS: "0" } : { SURFACES: "", LAYERS: String(this.layers) };
    material.defines = { ...this.fieldDefines, ...surfaces };
    material.needsUpdate = true;
  }

  private fillBricks(): void {
    const { bricks, drawn } = this;
    if (bricks !== null && drawn !== null) {
      const filled = filledBricks(bricks, (low, high) => drawn.any(low, high));
      this.filled = filled.map((full, i) => full | (this.labelled?.[i] ?? 0));
      this.measureEmptiness();
    }
  }

  /** Tells the shader how far it may leap. */
  private measureEmptiness(): void {
    if (this.filled !== null && this.bricks !== null) {
      const { counts } = this.bricks;
      this.uniforms.brickTexture.value?.dispose();
      this.uniforms.brickTexture.value = byteTexture(distanceToFilled(this.filled, counts), counts);
    }
  }
}

function inverted(v: Vec3): Vec3 {
  return [1 / v[0], 1 / v[1], 1 / v[2]];
}

/** Scale and offset from a value to the coordinate of a row whose end texels stand at its ends. */
function texelCoordinates(low: number, high: number, texels: number): readonly [number, number] {
  const perValue = (texels - 1) / texels / (high - low);
  return [perValue, 0.5 / texels - low * perValue];
}

/** Over the viewer's left shoulder. */
export function keyLight(camera: Camera): Vec3 {
  return normalize(add(add(scale(camera.right, -0.45), scale(camera.up, 0.65)), scale(camera.back, 0.75)));
}
