/**
 * Runs in the browser: draws a second scan, shown with a first one that is all air.
 */
import * as THREE from "three";
import type { Affine } from "../../src/core/geometry/affine";
import { brickRanges } from "../../src/core/scan/bricks";
import { extentOf, lookFrom } from "../../src/core/geometry/camera";
import { firstLighting } from "../../src/core/appearance/appearance";
import { shadedOptics, type Blend } from "../../src/core/appearance/optics";
import type { SecondAppearance } from "../../src/core/second/second_scan";
import type { TransferFunction } from "../../src/core/appearance/transfer_function";
import { FieldTexture, type FieldFormat } from "../../src/gl/textures/field_texture";
import { PictureTarget } from "../../src/gl/base/picture_target";
import { RayMarcher } from "../../src/gl/march/ray_marcher";
import { scanOf, volumeOf } from "../support/volumes";
import type { MarchResult } from "./scenes_page";

export interface SecondTest {
  /** Points of the first scan to the second's; each of them is drawn. */
  readonly places: readonly Affine[];
  readonly blend: Blend;
  /** Extinction of either scan everywhere [1/mm]. */
  readonly first: number;
  readonly second: number;
  /** Half of the second scan holds nothing. */
  readonly half?: boolean;
  readonly step?: number;
  /** Of either scan's values on the GPU. */
  readonly format?: FieldFormat;
  /** Share of the second scan where a ray has one value, and of its iso-surface. */
  readonly opacity?: number;
  /** How the view shows both, in cells of which edge [mm], and whose turn it is. */
  readonly viewFusion?: SecondAppearance["viewFusion"];
  readonly square?: number;
  readonly turn?: SecondAppearance["turn"];
  /** Value of the first scan's iso-surface. */
  readonly isoValue?: number;
}

const edge = 96;
const size = 48;
const inside = 100;
const air = -1000;

function everywhere(extinction: number, colour: readonly [number, number, number]): TransferFunction {
  return {
    points: [
      { value: -500, colour, extinction: 0 },
      { value: 0, colour, extinction },
      { value: 500, colour, extinction },
    ],
  };
}

/** A picture for each place of the second scan: 40³ voxels of 0.5 mm. */
export function second(test: SecondTest): MarchResult[] {
  const renderer = new THREE.WebGLRenderer({ canvas: document.createElement("canvas") });
  renderer.autoClear = false;
  const volume = volumeOf(scanOf([size, size, size], [1, 1, 1]), () => (test.first > 0 ? inside : air));
  const field = new FieldTexture(volume, test.format ?? "rg8");
  while (!field.uploadSlab(renderer));
  const marcher = new RayMarcher();
  marcher.setField(field, brickRanges(volume));
  marcher.setAppearance({
    transferFunction: everywhere(test.first, [1, 0, 0]),
    ranges: [],
    edgeGradient: 40,
    lighting: { ...firstLighting, edges: 0 },
    optics: { ...shadedOptics, blend: test.blend, isoValue: test.isoValue ?? shadedOptics.isoValue },
  });
  const extent = extentOf([0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? size : 0, i & 2 ? size : 0, i & 4 ? size : 0]));
  const camera = lookFrom("A", extent, { width: edge, height: edge });
  marcher.setCamera(camera, extent, 1);
  const other = volumeOf(
    scanOf([40, 40, 40], [0.5, 0.5, 0.5]),
    ([x]) => (test.half === true && x > 20 ? air : inside),
    test.step ?? 1,
  );
  const grey = { window: 400, level: inside };
  const appearance: SecondAppearance = {
    inView: true,
    viewFusion: test.viewFusion ?? "blend",
    inSlices: true,
    transferFunction: everywhere(test.second, [0, 0, 1]),
    density: 1,
    edgeGradient: 40,
    isoValue: 0,
    tissueFrom: -300,
    windows: { mip: grey, minip: grey, average: grey },
    window: { window: 400, level: 40 },
    fusion: "blend",
    tint: "grey",
    opacity: test.opacity ?? 1,
    square: test.square ?? 20,
    lines: [],
    turn: test.turn ?? "second",
  };
  const target = new PictureTarget(true);
  target.resize(edge, edge);
  target.useLevel(1);
  target.useRows(0, edge);
  const results = test.places.map((place) => {
    marcher.setSecond({ volume: other, bricks: other.bricks, place, appearance });
    while (marcher.second.isAwaited) {
      marcher.uploadSecond(renderer);
    }
    marcher.draw(renderer, target, { stepsPerVoxel: 4, jitter: false }, [0, 0, 0]);
    const halves = new Uint16Array(4 * edge * edge);
    renderer.readRenderTargetPixels(target.target, 0, 0, edge, edge, halves);
    return { pixels: Array.from(halves, (half) => THREE.DataUtils.fromHalfFloat(half)), camera, extent };
  });
  marcher.dispose();
  renderer.dispose();
  renderer.forceContextLoss();
  return results;
}
