/**
 * Runs in the browser: a scan that is drawn coarsely, then as far as it has arrived, then whole.
 */
import { brickRanges, coveringRanges } from "../../src/core/scan/bricks";
import { PlaneInterpolation } from "../../src/core/scan/plane_interpolation";
import { firstQuality } from "../../src/core/view/quality";
import type { ShownSlice } from "../../src/gl/picture/slices";
import { edge, fieldOf, appearanceOf, outlineOf, viewOf, voxels, type MarchTest } from "./scenes_page";
import { finished, pictureOf, pixelsOf } from "./screen_page";

export interface ArrivingResult {
  /** As fine as each gets; sRGB bytes, rows from the bottom. */
  readonly coarse: number[];
  readonly part: number[];
  readonly whole: number[];
  /** Planes that were drawn with their own values each time. */
  readonly planes: readonly number[];
  /** The coarsest that was on display between the coarse picture and that of the part. */
  readonly worst: number;
  /** Programs that were linked after the coarse picture. */
  readonly links: number;
}

/** Draws a scan with a coronal slice to the left of the view; of its planes some have arrived, then all. */
export async function arriving(test: MarchTest, arrived: number): Promise<ArrivingResult> {
  const drawn = pictureOf(false);
  const { picture, gl } = drawn;
  const own = fieldOf(test);
  const coarse = { ...fieldOf({ ...test, step: 3 }), frame: own.frame };
  const extent = outlineOf(test);
  // nothing fits into so short a frame: while the view moves it would be as coarse as it gets
  picture.setQuality({ ...firstQuality(true), frameBudget: 0.01 });
  picture.contents.setScan(coarse, brickRanges(coarse));
  picture.contents.setAppearance(appearanceOf(test));
  picture.setCamera(viewOf(test, extent), extent);
  picture.resize(edge, edge, { x: edge / 2, y: 0, width: edge / 2, height: edge });
  picture.contents.setSliceAppearance({ window: 2000, level: 0, slab: 0, slabMode: "mean", fill: 0, outline: 0 });
  picture.contents.setSlices([coronal(extent.centre)]);
  const pictures = [await finished(drawn)];
  const planes = [picture.arrived];
  let links = 0;
  const { linkProgram } = gl;
  gl.linkProgram = (program): void => {
    links += 1;
    linkProgram.call(gl, program);
  };

  const behind = new PlaneInterpolation(coarse, own.dimensions, 1).make(arrived, voxels);
  const volume = { ...own, values: Uint16Array.from(own.values) };
  volume.values.set(behind, arrived * voxels ** 2);
  // what stands in for values and is not covered by theirs is covered all the same
  picture.contents.refineScan(volume, coveringRanges(brickRanges(volume), brickRanges(own)), arrived);
  let worst = 0;
  do {
    picture.advance(performance.now());
    worst = Math.max(worst, picture.shown.divisor);
    await new Promise((resolve) => setTimeout(resolve, 5));
  } while (!picture.shown.finished || !picture.hasPicture);
  pictures.push(pixelsOf(drawn));
  planes.push(picture.arrived);

  volume.values.set(own.values);
  picture.contents.setScan(volume, brickRanges(own));
  pictures.push(await finished(drawn));
  planes.push(picture.arrived);
  picture.dispose();
  const [first = [], part = [], whole = []] = pictures;
  return { coarse: first, part, whole, planes, worst, links };
}

/** As high as the scan, superior up, and half as wide. */
function coronal(centre: readonly [number, number, number]): ShownSlice {
  const rect = { x: 0, y: 0, width: edge / 2, height: edge };
  return {
    name: "coronal",
    rect,
    plane: { centre, right: [1, 0, 0], up: [0, 0, 1], toward: [0, -1, 0], pixel: voxels / edge },
  };
}
