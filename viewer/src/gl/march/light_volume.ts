/**
 * How much light reaches each place of the scan through what is drawn of it: the share of the sky around,
 * and of the lamp. A coarse volume, worked out layer by layer between two pictures: first how opaque each
 * cell is, then what comes through. The one before is looked up until the next is whole.
 *
 * Source: Hernell et al., "Local ambient occlusion", IEEE TVCG 16 (2010); for the volume of light from a
 * direction Behrens & Ratering, "Adding shadows to a texture-based volume renderer", IEEE VolVis (1998).
 */
import * as THREE from "three";
import { cellShares, layersReached, lightGridOf, type LightGrid } from "../../core/appearance/light_grid";
import type { ScanFrame } from "../../core/scan/scan_volume";
import { brickEdge } from "../../core/scan/bricks";
import { FullscreenPass, type Uniforms } from "../base/fullscreen_pass";
import { shaders } from "../shaders/shaders";

/** A place is looked up this far before its surface [cells], so that it does not shade itself. */
const lead = 1.5;

/** How far what stands around takes of the sky [mm]. */
const skyReach = 40;

type Layers = readonly [number, number];

/** What is being worked out: cells' opacity in some layers, or the light in all. */
interface LightJob {
  readonly keepsSky: boolean;
  readonly opacity: Layers;
  /** Next layer of the opacity, then of the light. */
  next: { readonly of: "opacity" | "light"; readonly layer: number };
}

export class LightVolume {
  private readonly blank = white();
  /** What shaders look light up with (`shaders/light/light_volume.glsl`). */
  readonly uniforms = {
    lightTexture: { value: this.blank },
    /** Of occlusion and of shadow that is seen. */
    lightShare: { value: new THREE.Vector2() },
    lightLead: { value: 0 },
  };
  private readonly own = {
    cells: { value: new THREE.Vector3(1, 1, 1) },
    layer: { value: 0 },
    cellEdge: { value: 1 },
    cellShares: { value: new THREE.Vector3() },
    skyReach: { value: 1 },
    emptyReach: { value: 1e9 },
    keyDirection: { value: new THREE.Vector3() },
    keepsSky: { value: 0 },
    opacityTexture: { value: null as THREE.Texture | null },
    lightBefore: { value: null as THREE.Texture | null },
  };
  private readonly opacityPass: FullscreenPass;
  private readonly lightPass: FullscreenPass;
  private frame: ScanFrame | null = null;
  private grid: LightGrid | null = null;
  private opacity: THREE.WebGL3DRenderTarget | null = null;
  private shown: THREE.WebGL3DRenderTarget | null = null;
  private working: THREE.WebGL3DRenderTarget | null = null;
  private used = false;
  /** Layers of cells whose opacity is no longer known, and whether the lamp stands elsewhere. */
  private unknown: Layers | null = null;
  private keyMoved = false;
  private readonly key = new THREE.Vector3();
  private job: LightJob | null = null;

  /**
   * @param march uniforms of the ray caster, which tell what is drawn.
   * @param most cells along the scan's longest edge.
   */
  constructor(
    march: Uniforms,
    private readonly most: number,
  ) {
    this.opacityPass = new FullscreenPass(shaders.cellOpacity, { ...march, ...this.own });
    this.lightPass = new FullscreenPass(shaders.cellLight, { ...march, ...this.own });
  }

  setFrame(frame: ScanFrame): void {
    this.release();
    const grid = lightGridOf(frame, this.most);
    const [, , depth] = grid.counts;
    this.frame = frame;
    this.grid = grid;
    this.unknown = [0, depth];
    const { own, uniforms } = this;
    own.cells.value.set(...grid.counts);
    own.cellEdge.value = grid.edge;
    own.cellShares.value.set(...cellShares(frame, grid));
    own.skyReach.value = skyReach / grid.edge;
    uniforms.lightLead.value = lead * grid.edge;
    // bricks, in which nothing is drawn, around a cell that no surface looks up
    const voxels = grid.edge / Math.min(...frame.spacing);
    own.emptyReach.value = Math.ceil(((lead + 2) * voxels) / brickEdge) + 1;
  }

  /** How much of occlusion and shadow is seen, 0..1; where neither is, nothing is worked out. */
  use(occlusion: number, shadow: number): void {
    this.uniforms.lightShare.value.set(occlusion, shadow);
    this.used = occlusion > 0 || shadow > 0;
  }

  get isUsed(): boolean {
    return this.used && this.grid !== null;
  }

  /** Chooses the shaders' variant; what is drawn is told by the ray caster's own definitions. */
  compile(defines: Readonly<Record<string, string>>): void {
    for (const { material } of [this.opacityPass, this.lightPass]) {
      material.defines = { ...defines };
      material.needsUpdate = true;
    }
  }

  /** What is drawn has changed: everywhere, or in planes of the whole scan's grid, half open. */
  changed(planes?: Layers): void {
    if (this.grid !== null && this.frame !== null) {
      const layers: Layers =
        planes === undefined ? [0, this.grid.counts[2]] : layersReached(this.frame, this.grid, ...planes);
      this.unknown =
        this.unknown === null ? layers : [Math.min(this.unknown[0], layers[0]), Math.max(this.unknown[1], layers[1])];
    }
  }

  /** The lamp stands in another direction, along the grid's axes. */
  turnKey(direction: THREE.Vector3): void {
    if (direction.distanceToSquared(this.key) > 1e-8) {
      this.key.copy(direction);
      this.keyMoved = true;
    }
  }

  /** The light on display is not that of what is drawn. */
  get pending(): boolean {
    const moved = this.keyMoved && this.uniforms.lightShare.value.y > 0;
    return this.isUsed && (this.job !== null || this.unknown !== null || moved || this.shown === null);
  }

  /** Works out some more layers; true where another light is on display than before. */
  advance(renderer: THREE.WebGLRenderer, layers: number): boolean {
    let renewed = false;
    for (let i = 0; i < layers && this.pending; ++i) {
      this.job ??= this.begin();
      renewed = this.drawLayer(renderer, this.job) || renewed;
    }
    return renewed;
  }

  /** Light of a layer of cells: sky and lamp in turn, 0..255, x fastest. */
  read(renderer: THREE.WebGLRenderer, layer: number): Uint8Array {
    const { grid, shown } = this;
    if (grid === null || shown === null) {
      throw new Error("there is no light yet");
    }
    const [width, height] = grid.counts;
    const texels = new Uint8Array(2 * width * height);
    renderer.setRenderTarget(shown, layer);
    renderer.readRenderTargetPixels(shown, 0, 0, width, height, texels);
    return texels;
  }

  get counts(): LightGrid["counts"] {
    return this.grid?.counts ?? [0, 0, 0];
  }

  dispose(): void {
    this.release();
    this.blank.dispose();
    this.opacityPass.dispose();
    this.lightPass.dispose();
  }

  private release(): void {
    for (const target of [this.opacity, this.shown, this.working]) {
      target?.dispose();
    }
    this.opacity = null;
    this.shown = null;
    this.working = null;
    this.job = null;
    this.uniforms.lightTexture.value = this.blank;
  }

  /** What has changed until now is taken; what changes meanwhile is for the next time. */
  private begin(): LightJob {
    const opacity = this.unknown ?? [0, 0];
    const keepsSky = this.unknown === null && this.shown !== null;
    this.unknown = null;
    this.keyMoved = false;
    this.own.keyDirection.value.copy(this.key);
    const none = opacity[0] >= opacity[1];
    return { keepsSky, opacity, next: none ? { of: "light", layer: 0 } : { of: "opacity", layer: opacity[0] } };
  }

  private drawLayer(renderer: THREE.WebGLRenderer, job: LightJob): boolean {
    const { own } = this;
    const { counts } = this.grid ?? { counts: [1, 1, 1] as const };
    const { of, layer } = job.next;
    own.layer.value = layer;
    if (of === "opacity") {
      this.opacity ??= cellsOf(counts, THREE.RedFormat);
      this.opacityPass.draw(renderer, this.opacity, layer);
      const last = layer + 1 >= job.opacity[1];
      job.next = last ? { of: "light", layer: 0 } : { of, layer: layer + 1 };
      return false;
    }
    this.working ??= cellsOf(counts, THREE.RGFormat);
    own.opacityTexture.value = this.opacity?.texture ?? null;
    own.lightBefore.value = this.shown?.texture ?? null;
    own.keepsSky.value = job.keepsSky ? 1 : 0;
    this.lightPass.draw(renderer, this.working, layer);
    if (layer + 1 < counts[2]) {
      job.next = { of, layer: layer + 1 };
      return false;
    }
    [this.shown, this.working] = [this.working, this.shown];
    // the types of three know a 3-D target's texture as any
    this.uniforms.lightTexture.value = this.shown.texture as unknown as THREE.Data3DTexture;
    this.job = null;
    return true;
  }
}

function cellsOf([width, height, depth]: LightGrid["counts"], format: THREE.PixelFormat): THREE.WebGL3DRenderTarget {
  return new THREE.WebGL3DRenderTarget(width, height, depth, {
    format,
    type: THREE.UnsignedByteType,
    minFilter: THREE.LinearFilter,
    magFilter: THREE.LinearFilter,
    generateMipmaps: false,
    depthBuffer: false,
  });
}

/** Light comes everywhere. */
function white(): THREE.Data3DTexture {
  const texture = new THREE.Data3DTexture(new Uint8Array([255, 255]), 1, 1, 1);
  texture.format = THREE.RGFormat;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}
