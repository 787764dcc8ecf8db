/**
 * Runs in the browser: surfaces and ray caster as the refiner drives them.
 */
import * as THREE from "three";
import { brickRanges, labelledBricks } from "../../src/core/scan/bricks";
import { lookFrom, type Camera } from "../../src/core/geometry/camera";
import type { Segment } from "../../src/core/protocol";
import { drawnFromVoxels, rangesInside, shownRanges, type InsideModes } from "../../src/core/segments/shown_segments";
import { decodeSurface } from "../../src/core/surfaces/surface_patches";
import type { Vec3 } from "../../src/core/geometry/vector";
import { FieldTexture } from "../../src/gl/textures/field_texture";
import { byteTexture, labelColours } from "../../src/gl/textures/lookup_textures";
import { PictureTarget } from "../../src/gl/base/picture_target";
import { RayMarcher } from "../../src/gl/march/ray_marcher";
import { Surfaces } from "../../src/gl/surfaces/surfaces";
import { ThreeCamera } from "../../src/gl/base/three_camera";
import { ballSurface } from "../support/ball_surface";
import { segment } from "../support/volumes";
import { edge, fieldOf, labelsOfBall, appearanceOf, outlineOf, viewport, type MarchTest } from "./scenes_page";
import type { SurfaceTest } from "./screen_page";

function segmentsOf(balls: readonly SurfaceTest[]): Segment[] {
  return balls.map(({ appearance }, i) => ({ ...segment, shown_as: "surface", id: i + 1, ...appearance }));
}

/** Surfaces and ray caster as the refiner drives them, for one view of the scan. */
function surfaceBench(test: MarchTest, balls: readonly SurfaceTest[], view: Camera, modes: InsideModes = {}) {
  const renderer = new THREE.WebGLRenderer({ canvas: document.createElement("canvas") });
  renderer.autoClear = false;
  renderer.info.autoReset = false;
  const volume = fieldOf(test);
  const field = new FieldTexture(volume, "rg8");
  while (!field.uploadSlab(renderer));
  const marcher = new RayMarcher({ software: test.software ?? true, lightCells: 64 });
  marcher.setField(field, brickRanges(volume));
  marcher.setAppearance(appearanceOf(test));
  const surfaces = new Surfaces(marcher, true);
  surfaces.setFrame(volume.frame);
  surfaces.setSegments(segmentsOf(balls), modes);
  surfaces.apply(
    renderer,
    balls.map(({ centre, radius, sectors, rings }, i) =>
      decodeSurface(ballSurface(i + 1, centre, radius, sectors, rings)),
    ),
  );
  const extent = outlineOf(test);
  const camera = new ThreeCamera();
  camera.update(view, extent, 1);
  surfaces.setCamera(view, camera.camera);
  marcher.setCamera(view, extent, 1);
  const picture = new PictureTarget(true);
  picture.resize(edge, edge);
  const close = (): void => {
    renderer.dispose();
    renderer.forceContextLoss();
  };
  return { renderer, marcher, surfaces, picture, volume, close };
}

type Bench = ReturnType<typeof surfaceBench>;

function drawnWith(
  { renderer, marcher, surfaces, picture }: Bench,
  stepsPerVoxel: number,
  detail: "all" | "few",
): Detailed {
  picture.useLevel(1);
  picture.useRows(0, picture.height);
  const tally = surfaces.draw(renderer, picture, { divisor: 1, stepsPerVoxel, shift: [0, 0, 0], depth: 4, detail });
  marcher.draw(renderer, picture, { stepsPerVoxel, jitter: false }, [0, 0, 0]);
  const halves = new Uint16Array(4 * picture.width * picture.height);
  renderer.readRenderTargetPixels(picture.target, 0, 0, picture.width, picture.height, halves);
  return { pixels: Array.from(halves, (half) => THREE.DataUtils.fromHalfFloat(half)), ...tally };
}

/**
 * Surfaces of segments that are balls of the scan, with all triangles, with few and with all again; one without a range
 * is known by its labels.
 */
export function embodied(test: MarchTest, balls: readonly SurfaceTest[], modes: InsideModes): Detailed[] {
  const view = lookFrom(test.from, outlineOf(test), viewport);
  const bench = surfaceBench(test, balls, view, modes);
  const { marcher, volume, close } = bench;
  const segments = segmentsOf(balls);
  marcher.setAppearance({
    ...appearanceOf(test),
    ranges: rangesInside(shownRanges(segments, volume.frame.rescale), modes),
  });
  marcher.setClip(test.clip ?? []);
  bench.surfaces.setClip(test.clip ?? []);
  if (segments.some(({ range }) => range === null)) {
    const ids = labelsOfBall(volume, false);
    marcher.setLabelColours(labelColours(segments, drawnFromVoxels, modes));
    marcher.setLabels({ texture: byteTexture(ids, volume.dimensions), bricks: labelledBricks(ids, volume.dimensions) });
  }
  const pictures = (["all", "few", "all"] as const).map((detail) => drawnWith(bench, test.stepsPerVoxel, detail));
  close();
  return pictures;
}

/** Triangles that are drawn of a ball in patches, from a camera `away` mm before `target`. */
export function drawnTriangles(ball: SurfaceTest, target: Vec3, away: number): number {
  const test: MarchTest = { field: "ball", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1 };
  const view = { ...lookFrom("A", outlineOf(test), viewport), target, distance: away };
  const { renderer, surfaces, picture, close } = surfaceBench(test, [ball], view);
  picture.useLevel(1);
  renderer.info.reset();
  surfaces.draw(renderer, picture, { divisor: 1, stepsPerVoxel: 1, shift: [0, 0, 0], depth: 4, detail: "all" });
  const { triangles } = renderer.info.render;
  close();
  return triangles;
}

/** A coarse level of the picture, drawn in strips; linear RGBA, rows from the bottom. */
export function coarseLevel(test: MarchTest, balls: readonly SurfaceTest[], divisor: number, strip: number): number[] {
  const view = lookFrom(test.from, outlineOf(test), viewport);
  const { renderer, marcher, surfaces, picture, close } = surfaceBench(test, balls, view);
  picture.useLevel(divisor);
  surfaces.draw(renderer, picture, {
    divisor,
    stepsPerVoxel: test.stepsPerVoxel,
    shift: [0, 0, 0],
    depth: 4,
    detail: "all",
  });
  for (let row = 0; row < picture.height; row += strip) {
    picture.useRows(row, Math.min(picture.height, row + strip));
    marcher.draw(renderer, picture, { stepsPerVoxel: test.stepsPerVoxel, jitter: false }, [0, 0, 0]);
  }
  const halves = new Uint16Array(4 * picture.width * picture.height);
  renderer.readRenderTargetPixels(picture.target, 0, 0, picture.width, picture.height, halves);
  close();
  return Array.from(halves, (half) => THREE.DataUtils.fromHalfFloat(half));
}

/** Pictures of surfaces: linear RGBA, rows from the bottom, and the triangles that were drawn in all layers. */
export interface Detailed {
  readonly pixels: number[];
  readonly drawn: number;
  readonly all: number;
}

/**
 * Surfaces drawn with all triangles; with few; with few of patches that come one by one; after an edit exchanged a
 * patch of the first; after edits exchanged all patches; some seconds later; and with all again.
 */
export function detailed(
  test: MarchTest,
  balls: readonly SurfaceTest[],
): Record<"all" | "few" | "inParts" | "partly" | "edited" | "later" | "again", Detailed> {
  const view = lookFrom(test.from, outlineOf(test), viewport);
  const bench = surfaceBench(test, balls, view);
  const { renderer, surfaces, close } = bench;
  const drawn = (detail: "all" | "few"): Detailed => {
    surfaces.prepareFew(Infinity);
    return drawnWith(bench, test.stepsPerVoxel, detail);
  };
  const changes = balls.map(({ centre, radius, sectors, rings }, i) => ({
    ...decodeSurface(ballSurface(i + 1, centre, radius, sectors, rings)),
    whole: false,
  }));
  const [all, few] = [drawn("all"), drawn("few")];
  for (const change of changes) {
    change.patches.forEach((patch, i) => {
      surfaces.apply(renderer, [{ ...change, whole: i === 0, patches: [patch] }]);
    });
  }
  const inParts = drawn("few");
  surfaces.apply(
    renderer,
    changes.slice(0, 1).map((change) => ({ ...change, patches: change.patches.slice(0, 1) })),
  );
  const partly = drawn("few");
  surfaces.apply(renderer, changes);
  const edited = drawn("few");
  const { performance } = window;
  const later = 5000;
  Object.defineProperty(window, "performance", { configurable: true, value: { now: () => performance.now() + later } });
  const pictures = { all, few, inParts, partly, edited, later: drawn("few"), again: drawn("all") };
  Object.defineProperty(window, "performance", { configurable: true, value: performance });
  close();
  return pictures;
}
