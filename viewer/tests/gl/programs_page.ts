/**
 * Runs in the browser: watches which programs the GPU is given for a first picture, and what it looks like.
 */
import { bricksOf, fieldOf, appearanceOf, outlineOf, viewOf, type MarchTest } from "./scenes_page";
import { finished, pictureOf, pixelsOf } from "./screen_page";

export interface ProgramsResult {
  /** Programs that are linked before there is a scan, until its first picture stands, and after that. */
  readonly links: readonly [number, number, number];
  /** The first picture, and the one that is as fine as it gets; sRGB bytes, rows from the bottom. */
  readonly first: number[];
  readonly whole: number[];
}

/** @param software as where the CPU draws, or as a GPU draws. */
export async function programs(test: MarchTest, software: boolean): Promise<ProgramsResult> {
  const { prototype } = WebGL2RenderingContext;
  const { linkProgram } = prototype;
  let links = 0;
  prototype.linkProgram = function (program): void {
    links += 1;
    linkProgram.call(this, program);
  };
  const drawn = pictureOf(false, software);
  const { picture } = drawn;
  const until = async (is: () => boolean): Promise<void> => {
    for (picture.advance(performance.now()); !is(); picture.advance(performance.now())) {
      await new Promise((resolve) => setTimeout(resolve, 5));
    }
  };
  try {
    await until(() => picture.isPrepared);
    const prepared = links;
    const volume = fieldOf(test);
    const extent = outlineOf(test);
    picture.contents.setScan(volume, bricksOf(volume, true));
    picture.contents.setAppearance(appearanceOf(test));
    picture.setCamera(viewOf(test, extent), extent);
    await until(() => picture.hasPicture);
    const awaited = links;
    const first = pixelsOf(drawn);
    const whole = await finished(drawn);
    return { links: [prepared, awaited - prepared, links - awaited], first, whole };
  } finally {
    prototype.linkProgram = linkProgram;
    picture.dispose();
  }
}
