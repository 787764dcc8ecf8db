/**
 * The second scan on the GPU: its values in a texture of their own, and how it is shown. Keep in sync with
 * `shaders/second*.glsl`.
 */
import * as THREE from "three";
import type { Affine } from "../../core/geometry/affine";
import { brickEdge, distanceToFilled, filledBricks, type BrickRanges } from "../../core/scan/bricks";
import { DrawnValues, type Drawn } from "../../core/appearance/drawn_values";
import { greyOf, isGrey, seenInGrey, usesTransferFunction, type Blend } from "../../core/appearance/optics";
import type { ScanFrame, ScanVolume } from "../../core/scan/scan_volume";
import { mostIsolines } from "../../core/second/isolines";
import { fusions, sharesFromGrid, tints, type SecondAppearance } from "../../core/second/second_scan";
import { biasedOf, physical, type Rescale } from "../../core/scan/stored_values";
import { domainOf, sample } from "../../core/appearance/transfer_function";
import type { WindowLevel } from "../../core/appearance/window_level";
import { FieldTexture, type FieldFormat } from "./field_texture";
import { byteTexture, transferTextures } from "./lookup_textures";

/** All that is shown of a second scan. */
export interface ShownSecond {
  readonly volume: ScanVolume;
  readonly bricks: BrickRanges;
  /** Points of the first scan to the second's, patient of each [mm]. */
  readonly place: Affine;
  readonly appearance: SecondAppearance;
}

export class SecondTexture {
  readonly uniforms = {
    secondTexture: { value: null as THREE.Texture | null },
    secondFromGrid: { value: new THREE.Matrix4() },
    secondGrey: { value: new THREE.Vector2() },
    secondRayGrey: { value: new THREE.Vector2() },
    secondFusion: { value: 0 },
    secondViewFusion: { value: 0 },
    secondTint: { value: 0 },
    secondOpacity: { value: 0 },
    secondSquare: { value: 1 },
    secondTurn: { value: 1 },
    secondLines: { value: Array.from({ length: mostIsolines }, () => new THREE.Vector4()) },
    secondLineCount: { value: 0 },
    secondTransfer: { value: null as THREE.Texture | null },
    secondScale: { value: new THREE.Vector2() },
    secondDensity: { value: 1 },
    secondEdge: { value: 1 },
    secondTissueFrom: { value: 0 },
    secondIso: { value: new THREE.Vector2() },
    secondIsoColour: { value: new THREE.Vector3() },
    secondBricks: { value: null as THREE.Texture | null },
    secondBrickScale: { value: new THREE.Vector3() },
    secondTextureScale: { value: new THREE.Vector3(1, 1, 1) },
    secondTextureOffset: { value: new THREE.Vector3() },
  };
  /** That of the first scan, which the same shader reads. */
  format: FieldFormat = "rg8";
  private field: FieldTexture | null = null;
  private shown: ShownSecond | null = null;
  private ready = false;
  private mode: Blend = "shaded";
  /** Of what is drawn in which bricks. */
  private filledBy = "";

  /** Shows another one, or the same in another way or elsewhere; null shows none. */
  set(shown: ShownSecond | null): void {
    if (shown?.volume !== this.shown?.volume) {
      this.release();
      this.field = shown === null ? null : new FieldTexture(shown.volume, this.format);
    }
    if (shown !== null && shown.appearance.transferFunction !== this.shown?.appearance.transferFunction) {
      this.setTransferFunction(shown);
    }
    this.shown = shown;
    if (shown !== null) {
      this.setAppearance(shown.appearance, shown.volume.frame.rescale);
    }
    this.fill();
  }

  /** Follows the way in which values along a ray become one colour. */
  setBlend(blend: Blend): void {
    this.mode = blend;
    if (this.shown !== null) {
      this.setAppearance(this.shown.appearance, this.shown.volume.frame.rescale);
      this.fill();
    }
  }

  /** Follows the first scan, or another place of this one. */
  stand(first: ScanFrame): void {
    if (this.shown !== null) {
      this.uniforms.secondFromGrid.value.fromArray(sharesFromGrid(first, this.shown.volume.frame, this.shown.place));
    }
  }

  /** Sends some of its values; true once, when all are there. */
  upload(renderer: THREE.WebGLRenderer): boolean {
    if (this.field === null || this.ready) {
      return false;
    }
    this.ready = this.field.uploadSlab(renderer);
    this.uniforms.secondTexture.value = this.field.texture;
    return this.ready;
  }

  /** Whether some of it is still to be sent. */
  get isAwaited(): boolean {
    return this.field !== null && !this.ready;
  }

  get inView(): boolean {
    return this.ready && this.shown?.appearance.inView === true;
  }

  get inSlices(): boolean {
    return this.ready && this.shown?.appearance.inSlices === true;
  }

  dispose(): void {
    this.release();
  }

  private release(): void {
    this.field?.dispose();
    this.field = null;
    this.shown = null;
    this.ready = false;
    const { secondBricks, secondTransfer } = this.uniforms;
    secondBricks.value?.dispose();
    secondTransfer.value?.dispose();
    secondBricks.value = null;
    secondTransfer.value = null;
    this.filledBy = "";
  }

  private setAppearance(appearance: SecondAppearance, rescale: Rescale): void {
    const u = this.uniforms;
    const window = windowOf(appearance, this.mode);
    u.secondGrey.value.set(...greyScale(appearance.window, rescale));
    u.secondRayGrey.value.set(...greyScale(window, rescale));
    u.secondFusion.value = fusions.indexOf(appearance.fusion);
    u.secondViewFusion.value = fusions.indexOf(appearance.viewFusion);
    u.secondTint.value = tints.indexOf(appearance.tint);
    u.secondOpacity.value = appearance.opacity;
    u.secondSquare.value = appearance.square;
    u.secondTurn.value = appearance.turn === "second" ? 1 : 0;
    u.secondLineCount.value = Math.min(appearance.lines.length, mostIsolines);
    appearance.lines.slice(0, mostIsolines).forEach(({ colour, value }, i) => {
      u.secondLines.value[i]?.set(...colour, biasedOf(value, rescale));
    });
    u.secondDensity.value = appearance.density;
    u.secondEdge.value = appearance.edgeGradient / Math.max(Math.abs(rescale.slope), 1e-12);
    u.secondTissueFrom.value = greyOf(appearance.tissueFrom, window);
    u.secondIso.value.set(rescale.slope, physical(0, rescale) - appearance.isoValue);
    u.secondIsoColour.value.set(...sample(appearance.transferFunction.points, appearance.isoValue).colour);
  }

  /** Tells the shader which bricks hold something that is drawn in this mode. */
  private fill(): void {
    if (this.shown === null) {
      return;
    }
    const { bricks, appearance, volume } = this.shown;
    const { isoValue, transferFunction } = appearance;
    const values = [this.mode, windowOf(appearance, this.mode), isoValue];
    const key = JSON.stringify(usesTransferFunction(this.mode) ? transferFunction : values);
    if (key !== this.filledBy) {
      this.filledBy = key;
      const drawn = drawnOf(appearance, this.mode, volume.frame.rescale);
      const filled = filledBricks(bricks, (from, to) => drawn.any(from, to));
      this.uniforms.secondBricks.value?.dispose();
      this.uniforms.secondBricks.value = byteTexture(distanceToFilled(filled, bricks.counts), bricks.counts);
    }
  }

  private setTransferFunction({ volume, appearance }: ShownSecond): void {
    const u = this.uniforms;
    const { rescale } = volume.frame;
    const { values, integrals } = transferTextures(appearance.transferFunction);
    integrals.dispose();
    u.secondTransfer.value?.dispose();
    u.secondTransfer.value = values;
    const [low = 0, high = 1] = domainOf(appearance.transferFunction).map((value) => biasedOf(value, rescale));
    u.secondScale.value.set(1 / (high - low), -low / (high - low));
    const [x, y, z] = volume.dimensions;
    u.secondBrickScale.value.set(x / brickEdge, y / brickEdge, z / brickEdge);
    // texel centres stand at half numbers: see core/scan/scan_volume.ts
    const { step } = volume;
    const [across, down, deep] = volume.frame.dimensions;
    const first = 0.5 - 0.5 / step;
    u.secondTextureScale.value.set(across / (x * step), down / (y * step), deep / (z * step));
    u.secondTextureOffset.value.set(first / x, first / y, first / z);
  }
}

/** The window where a ray has one value; any where it has not. */
function windowOf({ windows }: SecondAppearance, blend: Blend): WindowLevel {
  return isGrey(blend) ? windows[blend] : windows.mip;
}

/** Whether the 3-D view stays as it is: slices alone may show a second scan in another way, or the other of two. */
export function sameInView(one: ShownSecond | null, other: ShownSecond | null): boolean {
  const key = (shown: ShownSecond | null): string => {
    const { appearance, place } = shown ?? { appearance: null, place: null };
    const slices = {
      inSlices: null,
      window: null,
      fusion: null,
      lines: null,
      turn: appearance?.viewFusion === "flicker" ? appearance.turn : null,
    };
    return JSON.stringify([place, appearance?.inView === true ? { ...appearance, ...slices } : null]);
  };
  return one?.volume === other?.volume && key(one) === key(other);
}

/** Share of a window per biased value, and at 0. */
function greyScale(window: WindowLevel, rescale: Rescale): [number, number] {
  return [rescale.slope / Math.max(window.window, 1e-6), greyOf(physical(0, rescale), window)];
}

/** Which of its values are drawn. */
function drawnOf(appearance: SecondAppearance, blend: Blend, rescale: Rescale): Drawn {
  if (usesTransferFunction(blend)) {
    return new DrawnValues(appearance.transferFunction, rescale);
  }
  const { isoValue } = appearance;
  const window = windowOf(appearance, blend);
  return {
    any: (low, high) => seenInGrey({ blend, window, isoValue }, physical(low, rescale), physical(high, rescale)),
  };
}
