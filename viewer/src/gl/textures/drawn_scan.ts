/**
 * The scan's values on the GPU: those that are drawn, and finer ones, or more of them, that come to be drawn instead.
 */
import type * as THREE from "three";
import type { BrickRanges } from "../../core/scan/bricks";
import type { ScanVolume } from "../../core/scan/scan_volume";
import type { Box } from "../../core/scan/voxel_change";
import { FieldTexture, type FieldFormat } from "./field_texture";

/** Values that are drawn as soon as they are on the GPU; until then some are that are coarser, or fewer. */
interface LoadingField {
  readonly field: FieldTexture;
  readonly bricks: BrickRanges;
  /** Planes, from the first on, that have their own values. */
  readonly arrived: number;
}

/** What is drawn from now on. */
export interface Taken {
  readonly field: FieldTexture;
  readonly bricks: BrickRanges;
  /** It lies in a texture of its own; else there is more in the one that was drawn. */
  readonly isNew: boolean;
  /** All of the scan has its own values. */
  readonly isWhole: boolean;
}

const isWhole = ({ field, arrived }: LoadingField): boolean => arrived === field.volume.dimensions[2];

export class DrawnScan {
  private field: FieldTexture | null = null;
  private loading: LoadingField | null = null;
  /** Planes that are drawn with their own values; in others something stands in for them. */
  arrived = 0;
  /** There is something to draw. */
  ready = false;

  constructor(readonly format: FieldFormat) {}

  /** Of the scan that is drawn; null where there is none. */
  get frame(): ScanVolume["frame"] | null {
    return this.field?.volume.frame ?? null;
  }

  /** Share of what was given that is on the GPU. */
  get uploaded(): number {
    return this.latest?.progress ?? 0;
  }

  get isLoading(): boolean {
    return this.loading !== null;
  }

  /** What comes is all of the scan. */
  get comesWhole(): boolean {
    return this.loading !== null && isWhole(this.loading);
  }

  /** Begins with another scan, which is drawn once its values are on the GPU. */
  begin(volume: ScanVolume): FieldTexture {
    this.dispose();
    this.field = new FieldTexture(volume, this.format);
    this.arrived = volume.dimensions[2];
    this.ready = false;
    return this.field;
  }

  /** Gives more values of the scan that is drawn; the same object has more of them in the same texture. */
  bring(volume: ScanVolume, bricks: BrickRanges, arrived: number): void {
    const known = [this.loading?.field, this.field].find((field) => field?.volume === volume);
    const field = known ?? new FieldTexture(volume, this.format);
    field.follow(arrived);
    this.loading = { field, bricks, arrived };
  }

  /** Sends values that have changed in a box. */
  uploadBox(renderer: THREE.WebGLRenderer, box: Box): void {
    this.latest?.uploadBox(renderer, box);
  }

  /** Sends the next values; returns what is drawn instead of what was so far, or null. */
  upload(renderer: THREE.WebGLRenderer): Taken | null {
    const { loading, field } = this;
    if (loading !== null) {
      return loading.field.uploadSlab(renderer) ? this.take(loading) : null;
    }
    if (field !== null && !this.ready) {
      this.ready = field.uploadSlab(renderer);
    }
    return null;
  }

  dispose(): void {
    if (this.loading?.field !== this.field) {
      this.loading?.field.dispose();
    }
    this.field?.dispose();
    this.loading = null;
  }

  private get latest(): FieldTexture | null {
    return this.loading?.field ?? this.field;
  }

  private take(loading: LoadingField): Taken {
    const { field, bricks, arrived } = loading;
    const isNew = field !== this.field;
    if (isNew) {
      this.field?.dispose();
      this.field = field;
    }
    this.loading = null;
    this.arrived = arrived;
    this.ready = true;
    return { field, bricks, isNew, isWhole: isWhole(loading) };
  }
}
