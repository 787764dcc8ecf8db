/**
 * Runs in the browser: the picture as the page has it, on a canvas of its own.
 */
import * as THREE from "three";
import { orbit } from "../../src/core/geometry/camera";
import { decodeDisplacements, type Displacements } from "../../src/core/scan/displacements";
import { PathTrail } from "../../src/core/touch/path_trail";
import type { Segment } from "../../src/core/protocol";
import { firstQuality, type Quality } from "../../src/core/view/quality";
import { firstStereo, type Stereo } from "../../src/core/view/stereo";
import { decodeSurface } from "../../src/core/surfaces/surface_patches";
import { addScaled, type Vec3 } from "../../src/core/geometry/vector";
import { forEachCell, updateBricks, type Box } from "../../src/core/scan/voxel_change";
import { gpuSupport } from "../../src/gl/base/gpu_support";
import type { MarkerState } from "../../src/gl/markers/markers";
import { Picture } from "../../src/gl/picture/picture";
import { ballSurface } from "../support/ball_surface";
import { segment } from "../support/volumes";
import { bricksOf, edge, fieldOf, appearanceOf, outlineOf, viewOf, type MarchTest } from "./scenes_page";

/** Markers of a test, over those of a probe at rest in the middle. */
export type MarkerTest = Omit<Partial<MarkerState>, "trail"> & { readonly way?: readonly Vec3[] };

function stillMarkers(at: Vec3): Omit<MarkerState, "trail"> {
  const show = { contactPoint: true, normal: true, ball: true, path: true };
  const contact = { contact: false, contactPoint: at, normal: [0, 0, 0] as const };
  return {
    probe: at,
    device: at,
    force: [0, 0, 0],
    radius: 0,
    ...contact,
    show,
    tool: null,
    parts: null,
    pixel: 1,
    fullForce: 1,
  };
}

/** A way of the probe through points, a tenth of a second each. */
function trailThrough(way: readonly Vec3[]): PathTrail {
  const trail = new PathTrail(100, 64, 0.1);
  way.forEach((point, i) => {
    trail.add(i / 10, point);
  });
  return trail;
}

/** A picture of the page on a canvas of its own, with what a test does to it. */
export interface ScreenTest {
  readonly scan: MarchTest;
  readonly markers?: MarkerTest;
  readonly jitter?: boolean;
  /** Surfaces of balls, as segments have them. */
  readonly surfaces?: readonly SurfaceTest[];
  /** Tissue is displaced from its voxels by all of these; "none" where a model is at work and nothing has moved. */
  readonly displaced?: readonly DisplacedTest[] | "none";
  readonly stereo?: Stereo;
  /** Points of each mark. */
  readonly marks?: readonly (readonly Vec3[])[];
  /** How far behind the scan's middle the camera's target lies [mm]. */
  readonly behind?: number;
}

/** All nodes of a box move alike [mm along the grid's axes], but for those at its border. */
export interface DisplacedTest {
  /** First node, and from one to the next [grid]. */
  readonly origin: Vec3;
  readonly step: Vec3;
  readonly size: Vec3;
  readonly moved: Vec3;
}

function displacedBy({ origin, step, size, moved }: DisplacedTest): Displacements {
  const halves = moved.map((millimetres) => THREE.DataUtils.toHalfFloat(millimetres));
  const texels = new Uint16Array(4 * size[0] * size[1] * size[2]);
  const inside: Box = { low: [1, 1, 1], high: [size[0] - 1, size[1] - 1, size[2] - 1] };
  forEachCell(inside, size, (i) => {
    texels.set(halves, 4 * i);
  });
  return decodeDisplacements({
    origin: [...origin],
    step: [...step],
    size: [...size],
    moved: new Uint8Array(texels.buffer),
  });
}

export interface SurfaceTest {
  readonly centre: Vec3;
  readonly radius: number;
  /** Patches that the ball is cut into. */
  readonly sectors: number;
  /** From pole to pole. */
  readonly rings?: number;
  readonly appearance: Partial<Segment>;
}

export function showSurfaces(picture: Picture, surfaces: readonly SurfaceTest[]): void {
  const segments = surfaces.map(({ appearance }, i) => ({
    ...segment,
    shown_as: "surface" as const,
    id: i + 1,
    ...appearance,
  }));
  picture.contents.setSegments(segments);
  picture.contents.changeSurfaces(
    surfaces.map(({ centre, radius, sectors, rings }, i) =>
      decodeSurface(ballSurface(i + 1, centre, radius, sectors, rings)),
    ),
  );
}

/** The whole picture with markers; sRGB bytes, rows from the bottom. */
export function screen(test: MarchTest, markers: MarkerTest | null, jitter = false): Promise<number[]> {
  return show({ scan: test, jitter, ...(markers === null ? {} : { markers }) });
}

/** A scan drawn at a quality: with what it was drawn at rest, and how it looks; sRGB bytes, rows from the bottom. */
export async function refined(
  test: MarchTest,
  quality: Quality,
): Promise<{ readonly shown: Picture["shown"]; readonly pixels: number[] }> {
  const drawn = pictureOf(true);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  picture.setQuality({ ...firstQuality(true), quality });
  picture.contents.setScan(volume, bricksOf(volume, true));
  picture.contents.setAppearance(appearanceOf(test));
  picture.setCamera(viewOf(test, extent), extent);
  const pixels = await finished(drawn);
  const { shown } = picture;
  picture.dispose();
  return { shown, pixels };
}

/**
 * A picture on a canvas of its own, before anything stands on it; `software`: as where the CPU draws, or as a GPU
 * draws; else as the renderer is.
 */
export function pictureOf(
  jitter: boolean,
  software?: boolean,
): { readonly picture: Picture; readonly gl: WebGL2RenderingContext } {
  const support = gpuSupport();
  const canvas = document.createElement("canvas");
  if (support === null) {
    throw new Error("no WebGL2");
  }
  const picture = new Picture(canvas, {
    support: { ...support, software: software ?? support.software },
    mostPixelRatio: 1,
  });
  picture.jitter = jitter;
  // averages are what it is about: the same on the CPU as on a GPU
  picture.setQuality(firstQuality(!jitter));
  picture.resize(edge, edge);
  const gl = canvas.getContext("webgl2");
  if (gl === null) {
    throw new Error("no WebGL2 on the canvas");
  }
  return { picture, gl };
}

/** Has the next picture of a view that has moved on the screen. */
async function moved(picture: Picture): Promise<void> {
  const { pieces } = picture;
  do {
    picture.advance(performance.now());
    await new Promise((resolve) => setTimeout(resolve, 5));
  } while (picture.pieces === pieces);
  picture.advance(performance.now());
}

/** The picture once it is as fine as it gets; sRGB bytes, rows from the bottom. */
export async function finished(drawn: ReturnType<typeof pictureOf>, size = edge): Promise<number[]> {
  const { picture } = drawn;
  do {
    picture.advance(performance.now());
    await new Promise((resolve) => setTimeout(resolve, 5));
  } while (!picture.shown.finished || !picture.hasPicture);
  return pixelsOf(drawn, size);
}

/** What is on the screen; sRGB bytes, rows from the bottom. */
export function pixelsOf({ gl }: ReturnType<typeof pictureOf>, size = edge): number[] {
  // the screen may have fewer pixels, which the browser enlarges
  const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
  const bytes = new Uint8Array(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  return Array.from({ length: 4 * size * size }, (_, i) => {
    const [x, y] = [Math.floor(i / 4) % size, Math.floor(i / (4 * size))];
    return bytes[4 * (Math.floor((y * height) / size) * width + Math.floor((x * width) / size)) + (i % 4)] ?? 0;
  });
}

export async function show({
  scan: test,
  markers,
  jitter = false,
  surfaces = [],
  displaced,
  stereo,
  behind = 0,
  marks = [],
}: ScreenTest): Promise<number[]> {
  // edges of markers are smooth only where a GPU draws: here they are the same everywhere
  const drawn = pictureOf(jitter, true);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  if (stereo !== undefined) {
    picture.setStereo(stereo);
    picture.resize(edge, edge);
  }
  picture.contents.setScan(volume, bricksOf(volume, true));
  picture.contents.setAppearance(appearanceOf(test));
  const view = viewOf(test, extent);
  picture.setCamera(
    { ...view, target: addScaled(view.target, view.back, -behind), distance: view.distance + behind },
    extent,
  );
  picture.contents.setClip(test.clip ?? []);
  showSurfaces(picture, surfaces);
  if (displaced !== undefined) {
    picture.contents.setDeforming(true);
    picture.contents.setDisplaced(displaced === "none" ? [] : displaced.map(displacedBy));
  }
  if (markers !== undefined) {
    picture.contents.setMarkers({ ...stillMarkers(extent.centre), ...markers, trail: trailThrough(markers.way ?? []) });
  }
  picture.contents.setMarks(marks);
  const pixels = await finished(drawn);
  picture.dispose();
  return pixels;
}

/**
 * A view that moves where nothing is quick enough; what stands on the screen then, as sRGB bytes, rows from the bottom.
 */
export async function hasty(
  test: MarchTest,
  markers: MarkerTest,
): Promise<{ readonly divisor: number; readonly pixels: number[] }> {
  const drawn = pictureOf(false, true);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  picture.setQuality({ ...firstQuality(true), frameBudget: 1e-3 });
  picture.contents.setScan(volume, bricksOf(volume, true));
  picture.contents.setAppearance(appearanceOf(test));
  picture.contents.setMarkers({ ...stillMarkers(extent.centre), ...markers, trail: trailThrough([]) });
  picture.setCamera(viewOf(test, extent), extent);
  await finished(drawn);
  // how coarse it becomes hangs on what these few samples cost beside all else
  for (let tries = 0; tries < 20 && picture.shown.divisor < 4; ++tries) {
    await finished(drawn);
    picture.setCamera(viewOf(test, extent), extent);
    await moved(picture);
  }
  const { divisor } = picture.shown;
  const pixels = pixelsOf(drawn);
  picture.dispose();
  return { divisor, pixels };
}

/** By what the resolution of pictures was divided that were on the screen one after the other, from a move to rest. */
export async function steps(test: MarchTest): Promise<number[]> {
  const drawn = pictureOf(false, true);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  // nothing fits into it
  picture.setQuality({ ...firstQuality(true), frameBudget: 1e-3 });
  picture.resize(4 * edge, 4 * edge);
  picture.contents.setScan(volume, bricksOf(volume, true));
  picture.contents.setAppearance(appearanceOf(test));
  picture.setCamera(viewOf(test, extent), extent);
  await finished(drawn);
  for (let tries = 0; tries < 20 && picture.shown.divisor < 8; ++tries) {
    picture.setCamera(viewOf(test, extent), extent);
    await moved(picture);
  }
  const seen = [picture.shown.divisor];
  do {
    picture.advance(performance.now());
    seen.push(picture.shown.divisor);
    await new Promise((resolve) => setTimeout(resolve, 5));
  } while (!picture.shown.finished);
  picture.dispose();
  return seen.filter((divisor, i) => divisor !== seen[i - 1]);
}

export interface BoredResult {
  /** Before the hole, as it is seen first, and as fine as it gets; sRGB bytes, rows from the bottom. */
  readonly before: number[];
  readonly first: number[];
  readonly last: number[];
  /** By what resolutions of pictures were divided at most since then. */
  readonly worst: number;
}

/** A picture at rest, of whose scan a box becomes air. */
export async function bored(test: MarchTest, box: Box): Promise<BoredResult> {
  const drawn = pictureOf(false, true);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const bricks = bricksOf(volume, true);
  const extent = outlineOf(test);
  picture.contents.setScan(volume, bricks);
  picture.contents.setAppearance(appearanceOf(test));
  picture.setCamera(viewOf(test, extent), extent);
  const before = await finished(drawn);
  forEachCell(box, volume.dimensions, (i) => {
    volume.values[i] = 0;
  });
  updateBricks(bricks, volume, box);
  picture.contents.changeVoxels(box, { values: true, labels: false });
  let worst = 0;
  let first: number[];
  do {
    await moved(picture);
    worst = Math.max(worst, picture.shown.divisor);
    first = pixelsOf(drawn);
  } while (first.every((value, i) => value === before[i]));
  const last = await finished(drawn);
  worst = Math.max(worst, picture.shown.divisor);
  picture.dispose();
  return { before, first, last, worst };
}

/** Without a piece in so many seconds none comes any more: on a busy machine one takes long. */
const idleSeconds = 3;

/**
 * Pieces of a picture at rest that follow one frame when no other frame comes, and whether the picture is told as final
 * without one.
 */
export async function withoutFrames(
  test: MarchTest,
  software: boolean,
): Promise<{ readonly pieces: number; readonly finished: readonly [boolean, boolean] }> {
  const drawn = pictureOf(true, software);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  const pause = (milliseconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, milliseconds));
  picture.contents.setScan(volume, bricksOf(volume, true));
  picture.contents.setAppearance(appearanceOf(test));
  picture.setCamera(viewOf(test, extent), extent);
  await finished(drawn);
  // on a busy machine a piece may take longer than any pause
  const atRest = picture.pieces;
  picture.setCamera(viewOf(test, extent), extent);
  picture.advance(performance.now());
  while (picture.pieces === atRest) {
    await pause(50);
  }
  // the view has come to rest
  await pause(500);
  const moved = atRest + 1;
  // where the picture that moved took longer than that, all that a GPU draws at rest has followed it by itself
  if (picture.pieces === moved) {
    picture.advance(performance.now());
  }
  let pieces = 0;
  for (let idle = 0; pieces === 0 || idle < idleSeconds; idle++) {
    await pause(1000);
    const now = picture.pieces - moved;
    idle = now > pieces ? 0 : idle;
    pieces = now;
  }
  const untold = picture.shown.finished;
  picture.advance(performance.now());
  const told = picture.shown.finished;
  picture.dispose();
  return { pieces, finished: [untold, told] };
}

/**
 * What stands on the screen once the view has turned, each time while a marker stood elsewhere, and the same drawn at
 * once; sRGB bytes, rows from the bottom. With a canvas that keeps what is not drawn again, as where the CPU draws.
 */
export async function turned(
  test: MarchTest,
  probes: readonly Vec3[],
  marks: readonly (readonly Vec3[])[],
): Promise<readonly [number[], number[]]> {
  // much larger than the margin around what is drawn
  const size = 3 * edge;
  const extent = outlineOf(test);
  const volume = fieldOf(test);
  const view = { ...viewOf(test, extent), distance: 8 * viewOf(test, extent).distance };
  const begun = (shown: typeof marks): ReturnType<typeof pictureOf> => {
    const drawn = pictureOf(false, true);
    drawn.picture.resize(size, size);
    drawn.picture.contents.setScan(volume, bricksOf(volume, true));
    drawn.picture.contents.setAppearance(appearanceOf(test));
    drawn.picture.contents.setMarks(shown);
    return drawn;
  };
  const turnTo = (drawn: ReturnType<typeof pictureOf>, i: number): Promise<number[]> => {
    const probe = probes[i] ?? extent.centre;
    drawn.picture.contents.setMarkers({ ...stillMarkers(probe), trail: trailThrough([]) });
    drawn.picture.setCamera(orbit(view, 0.4 * i, 0.1 * i), extent);
    return finished(drawn, size);
  };
  const moved = begun(marks);
  for (const [i, probe] of probes.entries()) {
    await turnTo(moved, i);
    // it moves on while the view rests
    moved.picture.contents.setMarkers({ ...stillMarkers(addScaled(probe, [0, 0, 1], 100)), trail: trailThrough([]) });
    await finished(moved);
  }
  const fresh = begun(marks);
  const pixels = [await turnTo(moved, 0), await turnTo(fresh, 0)] as const;
  moved.picture.dispose();
  fresh.picture.dispose();
  return pixels;
}

/** A picture that was whole, and of which the GPU is drawing the next. */
async function atWork({ scan: test, surfaces = [] }: ScreenTest): Promise<ReturnType<typeof pictureOf>> {
  const drawn = pictureOf(false);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  picture.contents.setScan(volume, bricksOf(volume, true));
  picture.contents.setAppearance(appearanceOf(test));
  picture.setCamera(viewOf(test, extent), extent);
  showSurfaces(picture, surfaces);
  await finished(drawn);
  picture.setCamera(viewOf(test, extent), extent);
  picture.advance(performance.now());
  return drawn;
}

/**
 * The middle pixels of what two eyes see, one above the other, after the canvas was resized before either was drawn.
 */
export async function resizedEyes({ scan }: ScreenTest): Promise<number[][]> {
  const drawn = await atWork({ scan });
  const { picture, gl } = drawn;
  const stereo: Stereo = { ...firstStereo, mode: "stacked" };
  for (const size of [edge, edge / 2]) {
    picture.setStereo(stereo);
    picture.resize(size, size);
    // the GPU is at work: the screen is drawn from pictures that are not there yet
    picture.advance(performance.now());
  }
  await finished(drawn);
  const pixels = [3, 1].map((quarters) => {
    const pixel = new Uint8Array(4);
    gl.readPixels(edge / 4, (quarters * edge) / 8, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    return [...pixel];
  });
  picture.dispose();
  return pixels;
}

/** The middle pixel after the canvas became smaller while the GPU was at work. */
export async function resizedMiddle(test: ScreenTest): Promise<number[]> {
  const drawn = await atWork(test);
  const { picture, gl } = drawn;
  const size = edge / 2;
  picture.resize(size, size);
  // what was begun is not done: the screen is drawn from a picture that is not there yet
  picture.advance(performance.now());
  await finished(drawn);
  const pixel = new Uint8Array(4);
  gl.readPixels(size / 2, size / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  picture.dispose();
  return [...pixel];
}
