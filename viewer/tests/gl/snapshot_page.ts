/**
 * Runs in the browser: saves pictures.
 */
import type { Camera, Extent } from "../../src/core/geometry/camera";
import { firstStereo } from "../../src/core/view/stereo";
import { addScaled } from "../../src/core/geometry/vector";
import { bricksOf, fieldOf, appearanceOf, outlineOf, viewOf, type MarchTest } from "./scenes_page";
import { finished, pictureOf, showSurfaces, type ScreenTest } from "./screen_page";

/** A saved picture of a size, and the same pixels of the screen before and after; RGBA bytes, rows from the top. */
export async function snapshot(
  { scan: test, surfaces = [], stereo = firstStereo, behind = 0 }: ScreenTest,
  size: { readonly width: number; readonly height: number },
  transparent: boolean,
): Promise<{
  readonly saved: number[];
  readonly camera: Camera;
  readonly extent: Extent;
  readonly before: number[];
  readonly after: number[];
  readonly shares: number[];
}> {
  // in tiles as small as where the CPU draws
  const drawn = pictureOf(false, true);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  const view = viewOf(test, extent);
  const camera = { ...view, target: addScaled(view.target, view.back, -behind), distance: view.distance + behind };
  picture.contents.setScan(volume, bricksOf(volume, true));
  picture.contents.setAppearance(appearanceOf(test));
  picture.setCamera(camera, extent);
  showSurfaces(picture, surfaces);
  const before = await finished(drawn);
  const context = Object.assign(document.createElement("canvas"), size).getContext("2d");
  if (context === null) {
    throw new Error("no canvas");
  }
  const shares: number[] = [];
  const { signal } = new AbortController();
  await picture.snapshot(context, {
    camera,
    size,
    stereo,
    transparent,
    signal,
    progress: (share) => shares.push(share),
  });
  const saved = [...context.getImageData(0, 0, size.width, size.height).data];
  const after = await finished(drawn);
  picture.dispose();
  return { saved, camera, extent, before, after, shares };
}

/** What a snapshot says that is cancelled after its first tile. */
export async function cancelled(test: MarchTest): Promise<string> {
  const { picture } = pictureOf(false);
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  const camera = viewOf(test, extent);
  picture.contents.setScan(volume, bricksOf(volume, true));
  picture.contents.setAppearance(appearanceOf(test));
  picture.setCamera(camera, extent);
  while (!picture.hasPicture) {
    picture.advance(performance.now());
    await new Promise((resolve) => setTimeout(resolve, 5));
  }
  const context = Object.assign(document.createElement("canvas"), { width: 400, height: 400 }).getContext("2d");
  const aborter = new AbortController();
  const shares: number[] = [];
  const progress = (share: number): void => {
    shares.push(share);
    aborter.abort(new Error("cancelled"));
  };
  try {
    if (context !== null) {
      await picture.snapshot(context, {
        camera,
        size: { width: 400, height: 400 },
        stereo: firstStereo,
        transparent: false,
        signal: aborter.signal,
        progress,
      });
    }
  } catch (error) {
    return `${error instanceof Error ? error.message : String(error)} after ${String(shares.length)}`;
  } finally {
    picture.dispose();
  }
  return "not cancelled";
}
