/**
 * Draws slices through the scan, each in its pane of the screen. They read the same textures as the ray
 * caster, so that they follow every edit; a slice is drawn again where something of it has changed.
 */
import * as THREE from "three";
import { transformPoint, transformVector } from "../../core/geometry/affine";
import type { Rect } from "../../core/view/picture_layout";
import type { Segment } from "../../core/protocol";
import { smallestSpacing, type ScanFrame } from "../../core/scan/scan_volume";
import { drawnInSlices, mostRanges, shownRanges } from "../../core/segments/shown_segments";
import type { SliceName, SlicePlane } from "../../core/slices/slice_plane";
import { slabModes, type SlabMode } from "../../core/slices/slab";
import { biasedOf } from "../../core/scan/stored_values";
import { scale, subtract, type Vec3 } from "../../core/geometry/vector";
import type { WindowLevel } from "../../core/appearance/window_level";
import { FullscreenPass } from "../base/fullscreen_pass";
import { labelColours } from "../textures/lookup_textures";
import type { RayMarcher } from "../march/ray_marcher";
import { shaders } from "../shaders/shaders";

export interface ShownSlice {
  readonly name: SliceName;
  /** Of its pane [CSS pixels]. */
  readonly rect: Rect;
  readonly plane: SlicePlane;
}

export interface SliceAppearance extends WindowLevel {
  /** Thickness [mm]; 0 is a single plane. */
  readonly slab: number;
  readonly slabMode: SlabMode;
  /** Opacity of segments, 0..1. */
  readonly fill: number;
  readonly outline: number;
}

/** In sync with `shaders/picture/slice.frag`. */
const mostSamples = 96;
/** Of an outline [CSS pixels]. */
const outlineWidth = 1.25;
const ground: Vec3 = [11 / 255, 14 / 255, 18 / 255];

export class Slices {
  /** How many were drawn, again or anew. */
  drawn = 0;
  private readonly uniforms;
  private readonly pass: FullscreenPass;
  private shown: readonly ShownSlice[] = [];
  private appearance: SliceAppearance | null = null;
  private segments: readonly Segment[] = [];
  private frame: ScanFrame | null = null;
  private colours: THREE.DataTexture | null = null;
  /** Panes whose slice has changed since it was drawn. */
  private readonly stale = new Set<SliceName>();

  constructor(private readonly marcher: RayMarcher) {
    const vector = (): THREE.Vector3 => new THREE.Vector3();
    this.uniforms = {
      ...marcher.fieldUniforms,
      ...marcher.second.uniforms,
      rangeBounds: { value: Array.from({ length: mostRanges }, () => new THREE.Vector4()) },
      rangeColours: { value: Array.from({ length: mostRanges }, vector) },
      rangeCount: { value: 0 },
      bodies: { value: 0 },
      labelColours: { value: null as THREE.Texture | null },
      paneCorner: { value: new THREE.Vector2() },
      gridCorner: { value: vector() },
      gridRight: { value: vector() },
      gridUp: { value: vector() },
      slabStep: { value: vector() },
      slabSamples: { value: 1 },
      slabMode: { value: 0 },
      window: { value: new THREE.Vector2() },
      marks: { value: new THREE.Vector2() },
      outline: { value: outlineWidth },
      ground: { value: new THREE.Vector3(...ground) },
      pixelLength: { value: 1 },
    };
    this.pass = new FullscreenPass(shaders.slice, this.uniforms);
  }

  /** No slice is seen. */
  get isEmpty(): boolean {
    return this.shown.length === 0;
  }

  get isStale(): boolean {
    return this.stale.size > 0;
  }

  /** Follows a scan or labels that are others than before: which textures there are has changed. */
  follow(frame: ScanFrame | null): void {
    this.frame = frame;
    this.compile();
    this.applySegments();
    this.changed();
  }

  /**
   * Which slices are seen, and where; those that are the same object as before are not drawn again.
   *
   * @returns whether any stands elsewhere than before, so that something else is to be seen where it was.
   */
  show(shown: readonly ShownSlice[]): boolean {
    const places = (slices: readonly ShownSlice[]): string => JSON.stringify(slices.map(({ rect }) => rect));
    const elsewhere = places(shown) !== places(this.shown);
    for (const slice of shown) {
      if (!this.shown.includes(slice)) {
        this.stale.add(slice.name);
      }
    }
    this.shown = shown;
    return elsewhere;
  }

  setAppearance(appearance: SliceAppearance): void {
    this.appearance = appearance;
    this.compile();
    this.changed();
  }

  setSegments(segments: readonly Segment[]): void {
    this.segments = segments;
    this.applySegments();
    this.compile();
    this.changed();
  }

  /** All slices are to be drawn again. */
  changed(): void {
    this.shown.forEach(({ name }) => this.stale.add(name));
  }

  /**
   * Draws the slices that have changed, or all.
   *
   * @param height of the screen [CSS pixels]
   * @param ratio device pixels per CSS pixel
   */
  draw(renderer: THREE.WebGLRenderer, height: number, ratio: number, all: boolean): void {
    const { frame, appearance } = this;
    if (frame === null || appearance === null) {
      return;
    }
    for (const slice of this.shown) {
      if (all || this.stale.has(slice.name)) {
        this.place(slice, frame, appearance, height, ratio);
        const { x, y, width, height: tall } = slice.rect;
        renderer.setViewport(x, height - y - tall, width, tall);
        this.pass.draw(renderer, null);
        this.drawn += 1;
      }
    }
    this.stale.clear();
  }

  dispose(): void {
    this.colours?.dispose();
    this.pass.dispose();
  }

  /** Tells the shader where a slice lies. */
  private place(
    { plane, rect }: ShownSlice,
    frame: ScanFrame,
    appearance: SliceAppearance,
    height: number,
    ratio: number,
  ): void {
    const u = this.uniforms;
    const step = plane.pixel / ratio;
    const right = scale(plane.right, plane.pixel * (rect.width / 2));
    const up = scale(plane.up, plane.pixel * (rect.height / 2));
    const corner = subtract(subtract(plane.centre, right), up);
    u.gridCorner.value.set(...transformPoint(frame.gridFromScene, corner));
    u.gridRight.value.set(...transformVector(frame.gridFromScene, scale(plane.right, step)));
    u.gridUp.value.set(...transformVector(frame.gridFromScene, scale(plane.up, step)));
    u.paneCorner.value.set(rect.x * ratio, (height - rect.y - rect.height) * ratio);
    u.outline.value = outlineWidth * ratio;
    u.pixelLength.value = step;

    const samples = Math.min(mostSamples, 1 + Math.ceil(appearance.slab / smallestSpacing(frame)));
    const between = samples > 1 ? appearance.slab / (samples - 1) : 0;
    u.slabSamples.value = samples;
    u.slabStep.value.set(...transformVector(frame.gridFromScene, scale(plane.toward, between)));
    u.slabMode.value = slabModes.indexOf(appearance.slabMode);

    const ends = [appearance.level - appearance.window / 2, appearance.level + appearance.window / 2] as const;
    const [black, white] = [biasedOf(ends[0], frame.rescale), biasedOf(ends[1], frame.rescale)];
    u.window.value.set(black, 1 / (white - black));
    u.marks.value.set(appearance.fill, appearance.outline);
  }

  private applySegments(): void {
    if (this.frame === null) {
      return;
    }
    const u = this.uniforms;
    const ranges = shownRanges(this.segments, this.frame.rescale, drawnInSlices).slice(0, mostRanges);
    u.rangeCount.value = ranges.length;
    ranges.forEach((range, i) => {
      u.rangeBounds.value[i]?.set(range.low, range.high, range.visible ? 1 : 0, range.label);
      u.rangeColours.value[i]?.set(...range.colour);
    });
    this.colours?.dispose();
    this.colours = labelColours(this.segments, drawnInSlices);
    u.labelColours.value = this.colours;
  }

  /** Leaves out of the shader what nothing needs: segments where none is marked, a slab where a slice is a plane. */
  private compile(): void {
    const { material } = this.pass;
    const marked =
      this.segments.some(drawnInSlices) &&
      this.appearance !== null &&
      this.appearance.fill + this.appearance.outline > 0;
    const second = this.marcher.second.inSlices ? { SECOND: "" } : {};
    const slab = this.appearance !== null && this.appearance.slab > 0 ? { SLAB: "" } : {};
    const defines = { ...this.marcher.fieldDefines, ...second, ...(marked ? { MARKS: "" } : {}), ...slab };
    if (JSON.stringify(defines) !== JSON.stringify(material.defines)) {
      material.defines = defines;
      material.needsUpdate = true;
    }
  }
}
