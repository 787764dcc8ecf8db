/**
 * Small scans of the tests, and how they are looked at.
 */
import type { Letter } from "../../src/core/geometry/anatomy";
import { defaultSoftTissueAndBone, transferFunctionOf } from "../../src/core/appearance/soft_tissue_and_bone";
import { brickRanges, type BrickRanges } from "../../src/core/scan/bricks";
import { extentOf, inProjection, lookFrom, type Camera, type Extent } from "../../src/core/geometry/camera";
import type { Plane } from "../../src/core/view/clip";
import { firstLighting, type Lighting, type Appearance } from "../../src/core/appearance/appearance";
import { shadedOptics, type Optics } from "../../src/core/appearance/optics";
import type { ScanVolume } from "../../src/core/scan/scan_volume";
import { mostRanges } from "../../src/core/segments/shown_segments";
import type { TransferFunction } from "../../src/core/appearance/transfer_function";
import { distance, type Vec3 } from "../../src/core/geometry/vector";
import type { FieldFormat } from "../../src/gl/textures/field_texture";
import { scanOf, volumeOf } from "../support/volumes";
import { marble } from "./marble";

export interface MarchTest {
  /** What is cut away. */
  readonly clip?: readonly Plane[];
  readonly field: "flat" | "ball" | "label" | "marble";
  readonly optics?: Partial<Optics>;
  /** Physical value per stored one, of a ball. */
  readonly slope?: number;
  readonly lighting?: Partial<Lighting>;
  readonly spacing: Vec3;
  readonly from: Letter;
  readonly orthographic?: boolean;
  readonly stepsPerVoxel: number;
  readonly format?: FieldFormat;
  /** Subsampling of the scan. */
  readonly step?: number;
  /** As where the CPU draws, or as where a GPU does. */
  readonly software?: boolean;
  /** Leaps over empty bricks. */
  readonly skip?: boolean;
  /** Extinction everywhere [1/mm]; else the usual look with this opacity of soft tissue. */
  readonly extinction?: number;
  readonly softTissue?: number;
  /**
   * The ball as a visible or hidden segment; or as a red one around a green one 0.5 mm below; or as the last of many.
   */
  readonly segment?: "visible" | "hidden" | "nested" | "tinted" | "last";
  /** The segment's own factors on ambient and specular light; those of the box of labels too. */
  readonly material?: readonly [number, number];
  /** The segment has labels too, as an edited one: those of its values, without a box in front or not. */
  readonly labels?: "as values" | "with hole" | "without values";
}

export interface MarchResult {
  /** Premultiplied linear RGBA, rows from the bottom, shape [edge, edge, 4]. */
  readonly pixels: number[];
  readonly camera: Camera;
  readonly extent: Extent;
}

export const edge = 96;
export const voxels = 48;
export const viewport = { width: edge, height: edge };

export function fieldOf({ field, spacing, step = 1, slope = 1 }: MarchTest): ScanVolume {
  const scan = { ...scanOf([voxels, voxels, voxels], spacing), slope };
  const centre: Vec3 = [24 * spacing[0], 24 * spacing[1], 24 * spacing[2]];
  const value = (grid: Vec3): number => {
    const point: Vec3 = [grid[0] * spacing[0], grid[1] * spacing[1], grid[2] * spacing[2]];
    return Math.min(1000, Math.max(-1000, 400 * (14 - distance(point, centre)))) / slope;
  };
  return volumeOf(
    scan,
    field === "ball" ? value : field === "marble" ? marble : () => (field === "flat" ? 100 : -1000),
    step,
  );
}

export function appearanceOf(test: MarchTest): Appearance {
  const flat: TransferFunction = {
    points: [
      { value: -500, colour: [0.2, 0.4, 0.6], extinction: test.extinction ?? 0 },
      { value: 500, colour: [0.2, 0.4, 0.6], extinction: test.extinction ?? 0 },
    ],
  };
  const usual = { ...defaultSoftTissueAndBone({ softTissue: 40, bone: 250 }), softTissue: test.softTissue ?? 0 };
  const segment = {
    id: 1,
    low: 32768,
    high: 65535,
    colour: [0, 1, 0] as const,
    visible: test.segment !== "hidden",
    label: test.labels === undefined ? 0 : 1,
    tinted: test.segment === "tinted",
    material: test.material ?? [1, 1],
  } as const;
  const nested = [{ ...segment, low: 32968 }, { ...segment, id: 2, colour: [1, 0, 0] as const }];
  const nowhere = { ...segment, low: 65535, high: 65534, colour: [1, 0, 0] as const };
  const many = [...Array.from({ length: mostRanges - 1 }, (_, place) => ({ ...nowhere, id: place + 2 })), segment];
  const shown = { nested, last: many, visible: [segment], hidden: [segment], tinted: [segment] };
  const ranges = test.segment === undefined || test.labels === "without values" ? [] : shown[test.segment];
  return {
    transferFunction: test.extinction === undefined ? transferFunctionOf(usual) : flat,
    ranges,
    edgeGradient: 40,
    lighting: { ...firstLighting, ...test.lighting },
    optics: { ...shadedOptics, ...test.optics },
  };
}

export function bricksOf(volume: ScanVolume, skip: boolean): BrickRanges {
  const bricks = brickRanges(volume);
  return skip ? bricks : { ...bricks, low: bricks.low.fill(0), high: bricks.high.fill(65535) };
}

export function outlineOf({ spacing }: MarchTest): Extent {
  const [x, y, z] = [voxels * spacing[0], voxels * spacing[1], voxels * spacing[2]];
  return extentOf([0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? x : 0, i & 2 ? y : 0, i & 4 ? z : 0]));
}

export function viewOf({ from, orthographic = false }: MarchTest, extent: Extent): Camera {
  return inProjection(lookFrom(from, extent, viewport), orthographic, extent);
}

/** A box of label 7 in the middle of the scan, half as wide as it. */
export function labelsInBox(): Uint8Array {
  const inside = (i: number): boolean => i >= 12 && i < 36;
  return Uint8Array.from({ length: voxels ** 3 }, (_, i) =>
    inside(i % voxels) && inside(Math.floor(i / voxels) % voxels) && inside(Math.floor(i / voxels ** 2)) ? 7 : 0,
  );
}

/** Label 1 where the ball is, with or without a hole in its front. */
export function labelsOfBall(volume: ScanVolume, hole: boolean): Uint8Array {
  const inHole = (i: number): boolean => {
    const [x, y, z] = [i % voxels, Math.floor(i / voxels) % voxels, Math.floor(i / voxels ** 2)];
    return hole && x >= 20 && x < 29 && y < 20 && z >= 19 && z < 30;
  };
  return Uint8Array.from(volume.values, (value, i) => (value >= 32768 && !inHole(i) ? 1 : 0));
}
