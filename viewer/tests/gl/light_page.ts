/**
 * Runs in the browser: works out the light of small scans and hands the cells back.
 */
import * as THREE from "three";
import { brickRanges } from "../../src/core/scan/bricks";
import { extentOf, lookFrom } from "../../src/core/geometry/camera";
import type { Plane } from "../../src/core/view/clip";
import { firstLighting, type Lighting } from "../../src/core/appearance/appearance";
import { shadedOptics, type Blend } from "../../src/core/appearance/optics";
import { biasedOf } from "../../src/core/scan/stored_values";
import type { Vec3 } from "../../src/core/geometry/vector";
import { forEachCell, updateBricks, type Box } from "../../src/core/scan/voxel_change";
import { FieldTexture } from "../../src/gl/textures/field_texture";
import { keyLight } from "../../src/gl/march/key_light";
import { RayMarcher } from "../../src/gl/march/ray_marcher";
import { scanOf, volumeOf } from "../support/volumes";

/** Dense tissue in boxes of a scan of 48³ voxels of 1 mm, air around. */
export interface LightTest {
  /** Voxels that are dense, half open. */
  readonly dense: readonly Box[];
  /** Of dense tissue [1/mm]. */
  readonly extinction: number;
  readonly blend?: Blend;
  readonly lighting?: Partial<Lighting>;
  readonly clip?: readonly Plane[];
  /** A box that becomes air after the light was worked out. */
  readonly removed?: Box;
}

export interface LightResult {
  readonly counts: Vec3;
  /** Shares of sky and lamp of each cell, x fastest. */
  readonly sky: number[];
  readonly key: number[];
  readonly keyDirection: Vec3;
  /** Layers that were worked out after the edit, of opacity and light together. */
  readonly layersAfterEdit: number;
}

const size = 48;
const dense = 100;
const air = -1000;

function isInside({ low, high }: Box, [x, y, z]: Vec3): boolean {
  return low[0] <= x && x < high[0] && low[1] <= y && y < high[1] && low[2] <= z && z < high[2];
}

export function light(test: LightTest): LightResult {
  const renderer = new THREE.WebGLRenderer({ canvas: document.createElement("canvas") });
  renderer.autoClear = false;
  const scan = scanOf([size, size, size], [1, 1, 1]);
  const volume = volumeOf(scan, (grid) => (test.dense.some((box) => isInside(box, grid)) ? dense : air));
  const bricks = brickRanges(volume);
  const field = new FieldTexture(volume, "rg8");
  while (!field.uploadSlab(renderer));
  const marcher = new RayMarcher({ software: true, lightCells: 32 });
  marcher.setField(field, bricks);
  marcher.setAppearance({
    // straight in the value, so that what lies between two voxels keeps what both do
    transferFunction: {
      points: [
        { value: air, colour: [1, 1, 1], extinction: 0 },
        { value: dense, colour: [1, 1, 1], extinction: test.extinction },
      ],
    },
    ranges: [],
    edgeGradient: 40,
    lighting: { ...firstLighting, edges: 0, ...test.lighting },
    optics: { ...shadedOptics, isoValue: 0, blend: test.blend ?? "shaded" },
  });
  marcher.setClip(test.clip ?? []);
  const extent = extentOf([[0, 0, 0], [size, size, size]]);
  const camera = lookFrom("A", extent, { width: 1, height: 1 });
  marcher.setCamera(camera, extent, 1);
  const finish = (): number => {
    let layers = 0;
    for (; marcher.light.pending; ++layers) {
      marcher.light.advance(renderer, 1);
    }
    return layers;
  };
  finish();
  let layersAfterEdit = 0;
  if (test.removed !== undefined) {
    forEachCell(test.removed, volume.dimensions, (i) => {
      volume.values[i] = biasedOf(air, volume.frame.rescale);
    });
    updateBricks(bricks, volume, test.removed);
    field.uploadBox(renderer, test.removed);
    marcher.changeVoxels(test.removed, renderer);
    layersAfterEdit = finish();
  }
  const { counts } = marcher.light;
  const sky: number[] = [];
  const key: number[] = [];
  for (let layer = 0; layer < (marcher.light.isUsed ? counts[2] : 0); ++layer) {
    marcher.light.read(renderer, layer).forEach((byte, i) => (i % 2 === 0 ? sky : key).push(byte / 255));
  }
  marcher.dispose();
  renderer.dispose();
  renderer.forceContextLoss();
  return { counts, sky, key, keyDirection: keyLight(camera), layersAfterEdit };
}
