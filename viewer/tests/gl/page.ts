/**
 * Runs in the browser: draws small scans with the real ray caster and hands the pixels back.
 */
import * as THREE from "three";
import { defaultAppearance, transferFunctionOf } from "../../src/core/appearance";
import { brickRanges, labelledBricks, type BrickRanges } from "../../src/core/bricks";
import { extentOf, inProjection, lookFrom, type Camera, type Extent } from "../../src/core/camera";
import type { Plane } from "../../src/core/clip";
import type { Letter } from "../../src/core/anatomy";
import { decodeDisplaced, type Displaced } from "../../src/core/displaced";
import { firstLighting, type Lighting, type Look } from "../../src/core/look";
import type { ScanVolume } from "../../src/core/scan_volume";
import { shadedOptics, type Optics } from "../../src/core/optics";
import { firstStereo, type Stereo } from "../../src/core/stereo";
import { PathTrail } from "../../src/core/path_trail";
import type { TransferFunction } from "../../src/core/transfer_function";
import type { Changed, Segment, SegmentSurface } from "../../src/core/protocol";
import { decodeSurface } from "../../src/core/surface_patches";
import { addScaled, distance, type Vec3 } from "../../src/core/vector";
import { forEachCell, type Box } from "../../src/core/voxel_change";
import { FieldTexture, type FieldFormat } from "../../src/gl/field_texture";
import { gpuSupport } from "../../src/gl/gpu_support";
import { byteTexture, labelColours } from "../../src/gl/lookup_textures";
import type { MarkerState } from "../../src/gl/markers";
import { Picture } from "../../src/gl/picture";
import { PictureTarget } from "../../src/gl/picture_target";
import { RayMarcher } from "../../src/gl/ray_marcher";
import { Surfaces } from "../../src/gl/surfaces";
import { ThreeCamera } from "../../src/gl/three_camera";
import { ShownEdits } from "../../src/ui/shown_edits.svelte";
import { ballSurface } from "../core/ball_surface";
import { scanOf, segment, volumeOf } from "../core/volumes";
import { light } from "./light_page";
import { marble } from "./marble";
import { second } from "./second_page";

export interface MarchTest {
  /** What is cut away. */
  readonly clip?: readonly Plane[];
  readonly field: "flat" | "ball" | "label" | "marble";
  readonly optics?: Partial<Optics>;
  readonly lighting?: Partial<Lighting>;
  readonly spacing: Vec3;
  readonly from: Letter;
  readonly orthographic?: boolean;
  readonly stepsPerVoxel: number;
  readonly format?: FieldFormat;
  /** Subsampling of the scan. */
  readonly step?: number;
  /** Leaps over empty bricks. */
  readonly skip?: boolean;
  /** Extinction everywhere [1/mm]; else the usual look with this opacity of soft tissue. */
  readonly extinction?: number;
  readonly softTissue?: number;
  /** The ball as a visible or hidden segment; or as a red one around a green one 0.5 mm below. */
  readonly segment?: "visible" | "hidden" | "nested" | "tinted";
  /** The segment has labels too, as an edited one: those of its values, without a box in front or not. */
  readonly labels?: "as values" | "with hole" | "without values";
}

export interface MarchResult {
  /** Premultiplied linear RGBA, rows from the bottom, shape [edge, edge, 4]. */
  readonly pixels: number[];
  readonly camera: Camera;
  readonly extent: Extent;
}

const edge = 96;
const voxels = 48;
const viewport = { width: edge, height: edge };

function fieldOf({ field, spacing, step = 1 }: MarchTest): ScanVolume {
  const scan = scanOf([voxels, voxels, voxels], spacing);
  const centre: Vec3 = [24 * spacing[0], 24 * spacing[1], 24 * spacing[2]];
  const value = (grid: Vec3): number => {
    const point: Vec3 = [grid[0] * spacing[0], grid[1] * spacing[1], grid[2] * spacing[2]];
    return Math.min(1000, Math.max(-1000, 400 * (14 - distance(point, centre))));
  };
  return volumeOf(scan, field === "ball" ? value : field === "marble" ? marble : () => (field === "flat" ? 100 : -1000), step);
}

function lookOf(test: MarchTest): Look {
  const flat: TransferFunction = {
    points: [
      { value: -500, colour: [0.2, 0.4, 0.6], extinction: test.extinction ?? 0 },
      { value: 500, colour: [0.2, 0.4, 0.6], extinction: test.extinction ?? 0 },
    ],
  };
  const usual = { ...defaultAppearance({ softTissue: 40, bone: 250 }), softTissue: test.softTissue ?? 0 };
  const segment = { id: 1, low: 32768, high: 65535, colour: [0, 1, 0] as const, visible: test.segment !== "hidden", label: test.labels === undefined ? 0 : 1, tinted: test.segment === "tinted" };
  const nested = [{ ...segment, low: 32968 }, { ...segment, id: 2, colour: [1, 0, 0] as const }];
  const ranges = test.segment === undefined || test.labels === "without values" ? [] : test.segment === "nested" ? nested : [segment];
  return {
    transferFunction: test.extinction === undefined ? transferFunctionOf(usual) : flat,
    ranges,
    edgeGradient: 40,
    lighting: { ...firstLighting, ...test.lighting },
    optics: { ...shadedOptics, ...test.optics },
  };
}

function bricksOf(volume: ScanVolume, skip: boolean): BrickRanges {
  const bricks = brickRanges(volume);
  return skip ? bricks : { ...bricks, low: bricks.low.fill(0), high: bricks.high.fill(65535) };
}

function outlineOf({ spacing }: MarchTest): Extent {
  const [x, y, z] = [voxels * spacing[0], voxels * spacing[1], voxels * spacing[2]];
  return extentOf([0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? x : 0, i & 2 ? y : 0, i & 4 ? z : 0]));
}

function viewOf({ from, orthographic = false }: MarchTest, extent: Extent): Camera {
  return inProjection(lookFrom(from, extent, viewport), orthographic, extent);
}

/** A box of label 7 in the middle of the scan, half as wide as it. */
function labelsInBox(): Uint8Array {
  const inside = (i: number): boolean => i >= 12 && i < 36;
  return Uint8Array.from({ length: voxels ** 3 }, (_, i) =>
    inside(i % voxels) && inside(Math.floor(i / voxels) % voxels) && inside(Math.floor(i / voxels ** 2)) ? 7 : 0,
  );
}

/** Label 1 where the ball is, with or without a hole in its front. */
function labelsOfBall(volume: ScanVolume, hole: boolean): Uint8Array {
  const inHole = (i: number): boolean => {
    const [x, y, z] = [i % voxels, Math.floor(i / voxels) % voxels, Math.floor(i / voxels ** 2)];
    return hole && x >= 20 && x < 29 && y < 20 && z >= 19 && z < 30;
  };
  return Uint8Array.from(volume.values, (value, i) => (value >= 32768 && !inHole(i) ? 1 : 0));
}

function march(test: MarchTest): MarchResult {
  const renderer = new THREE.WebGLRenderer({ canvas: document.createElement("canvas") });
  renderer.autoClear = false;
  const volume = fieldOf(test);
  const field = new FieldTexture(volume, test.format ?? "rg8");
  while (!field.uploadSlab(renderer));
  const marcher = new RayMarcher();
  marcher.setField(field, bricksOf(volume, test.skip ?? true));
  marcher.setLook(lookOf(test));
  marcher.setClip(test.clip ?? []);
  if (test.field === "label") {
    const colours = labelColours([{ ...segment, id: 7, colour: [1, 0, 0], range: null }]);
    const ids = labelsInBox();
    const dimensions: Vec3 = [voxels, voxels, voxels];
    marcher.setLabelColours(colours);
    marcher.setLabels({ texture: byteTexture(ids, dimensions), bricks: labelledBricks(ids, dimensions) });
  }
  if (test.labels !== undefined) {
    const made_by = test.labels === "without values" ? null : ([0, 32767] as const);
    marcher.setLabelColours(labelColours([{ ...segment, colour: [0, 1, 0], range: null, made_by }]));
    const ids = labelsOfBall(volume, test.labels !== "as values");
    const { dimensions } = volume;
    marcher.setLabels({ texture: byteTexture(ids, dimensions), bricks: labelledBricks(ids, dimensions) });
  }

  const extent = outlineOf(test);
  const camera = viewOf(test, extent);
  marcher.setCamera(camera, extent, 1);
  const target = new PictureTarget(true);
  target.resize(edge, edge);
  target.useLevel(1);
  target.useRows(0, edge);
  marcher.draw(renderer, target, { stepsPerVoxel: test.stepsPerVoxel, jitter: false }, [0, 0, 0]);

  const halves = new Uint16Array(4 * edge * edge);
  renderer.readRenderTargetPixels(target.target, 0, 0, edge, edge, halves);
  renderer.dispose();
  renderer.forceContextLoss();
  return { pixels: Array.from(halves, (half) => THREE.DataUtils.fromHalfFloat(half)), camera, extent };
}

/** Markers of a test, over those of a probe at rest in the middle. */
export type MarkerTest = Omit<Partial<MarkerState>, "trail"> & { readonly way?: readonly Vec3[] };

function stillMarkers(at: Vec3): Omit<MarkerState, "trail"> {
  const show = { contactPoint: true, normal: true, ball: true, path: true };
  const contact = { contact: false, contactPoint: at, normal: [0, 0, 0] as const };
  return { probe: at, device: at, force: [0, 0, 0], radius: 0, ...contact, show, tool: null, parts: null, pixel: 1, fullForce: 1 };
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
  /** Surfaces of balls, as segments look them. */
  readonly surfaces?: readonly SurfaceTest[];
  /** Matter stands beside its voxels; "none" where a model is at work and nothing has moved. */
  readonly displaced?: DisplacedTest | "none";
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

function displacedBy({ origin, step, size, moved }: DisplacedTest): Displaced {
  const halves = moved.map((millimetres) => THREE.DataUtils.toHalfFloat(millimetres));
  const texels = new Uint16Array(4 * size[0] * size[1] * size[2]);
  const inside: Box = { low: [1, 1, 1], high: [size[0] - 1, size[1] - 1, size[2] - 1] };
  forEachCell(inside, size, (i) => {
    texels.set(halves, 4 * i);
  });
  const decoded = decodeDisplaced({ origin: [...origin], step: [...step], size: [...size], moved: new Uint8Array(texels.buffer) });
  if (decoded === null) {
    throw new Error("no displacements");
  }
  return decoded;
}

export interface SurfaceTest {
  readonly centre: Vec3;
  readonly radius: number;
  /** Patches that the ball is cut into. */
  readonly sectors: number;
  /** From pole to pole. */
  readonly rings?: number;
  readonly look: Partial<Segment>;
}

function showSurfaces(picture: Picture, surfaces: readonly SurfaceTest[]): void {
  const segments = surfaces.map(({ look }, i) => ({ ...segment, shown_as: "surface" as const, id: i + 1, ...look }));
  picture.setSegments(segments);
  picture.changeSurfaces(
    surfaces.map(({ centre, radius, sectors, rings }, i) => decodeSurface(ballSurface(i + 1, centre, radius, sectors, rings))),
  );
}

/** The whole picture with markers; sRGB bytes, rows from the bottom. */
function screen(test: MarchTest, markers: MarkerTest | null, jitter = false): Promise<number[]> {
  return show({ scan: test, jitter, ...(markers === null ? {} : { markers }) });
}

/** A picture on a canvas of its own, before anything stands on it. */
function pictureOf(jitter: boolean): { readonly picture: Picture; readonly gl: WebGL2RenderingContext } {
  const support = gpuSupport();
  const canvas = document.createElement("canvas");
  if (support === null) {
    throw new Error("no WebGL2");
  }
  const picture = new Picture(canvas, { support, mostPixelRatio: 1 });
  picture.jitter = jitter;
  picture.resize(edge, edge);
  const gl = canvas.getContext("webgl2");
  if (gl === null) {
    throw new Error("no WebGL2 on the canvas");
  }
  return { picture, gl };
}

/** The picture once it is as fine as it gets; sRGB bytes, rows from the bottom. */
async function finished({ picture, gl }: ReturnType<typeof pictureOf>): Promise<number[]> {
  do {
    picture.advance(performance.now());
    await new Promise((resolve) => setTimeout(resolve, 5));
  } while (!picture.quality.finished || !picture.hasPicture);
  const bytes = new Uint8Array(4 * edge * edge);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, edge, edge, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  return [...bytes];
}

async function show({ scan: test, markers, jitter = false, surfaces = [], displaced, stereo, behind = 0, marks = [] }: ScreenTest): Promise<number[]> {
  const drawn = pictureOf(jitter);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  if (stereo !== undefined) {
    picture.setStereo(stereo);
    picture.resize(edge, edge);
  }
  picture.setScan(volume, bricksOf(volume, true));
  picture.setLook(lookOf(test));
  const view = viewOf(test, extent);
  picture.setCamera({ ...view, target: addScaled(view.target, view.back, -behind), distance: view.distance + behind }, extent);
  picture.setClip(test.clip ?? []);
  showSurfaces(picture, surfaces);
  if (displaced !== undefined) {
    picture.setGives(true);
    picture.setDisplaced(displaced === "none" ? null : displacedBy(displaced));
  }
  if (markers !== undefined) {
    picture.setMarkers({ ...stillMarkers(extent.centre), ...markers, trail: trailThrough(markers.way ?? []) });
  }
  picture.setMarks(marks);
  const pixels = await finished(drawn);
  picture.dispose();
  return pixels;
}

/** The middle pixel after the canvas became smaller while the GPU was at work. */
async function resizedMiddle({ scan: test, surfaces = [] }: ScreenTest): Promise<number[]> {
  const drawn = pictureOf(false);
  const { picture, gl } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  picture.setScan(volume, bricksOf(volume, true));
  picture.setLook(lookOf(test));
  picture.setCamera(viewOf(test, extent), extent);
  showSurfaces(picture, surfaces);
  await finished(drawn);
  picture.setCamera(viewOf(test, extent), extent);
  picture.advance(performance.now());
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

/** An edit of a picture: a box of voxels gets a value and a label, a surface other patches. */
export interface EditTest {
  readonly scan: MarchTest;
  readonly low: Vec3;
  readonly high: Vec3;
  readonly value: number | null;
  readonly label: number | null;
  /** Of the segments, in the order of their ids. */
  readonly looks: readonly Partial<Segment>[];
  readonly before?: readonly SegmentSurface[];
  readonly surfaces?: readonly SegmentSurface[];
}

export interface EditResult {
  readonly before: number[];
  readonly after: number[];
  /** The same, drawn by a new picture from what the page holds after the edit. */
  readonly afresh: number[];
  /** Boxes that were sent to 3-D textures by the edit: x, y, z, width, height, depth. */
  readonly uploads: readonly (readonly number[])[];
  /** Calls that sent whole textures or buffers. */
  readonly buffers: number;
  readonly complaints: readonly string[];
  readonly milliseconds: number | null;
}

async function edit(test: EditTest): Promise<EditResult> {
  const complaints: string[] = [];
  const edits = new ShownEdits({
    complain: (text) => complaints.push(text),
    download: ({ dimensions }) => {
      const ids = new Uint8Array(dimensions[0] * dimensions[1] * dimensions[2]);
      return Promise.resolve({ ids, dimensions, bricks: labelledBricks(ids, dimensions) });
    },
  });
  const volume = fieldOf(test.scan);
  const held = { volume, bricks: brickRanges(volume) };
  const extent = outlineOf(test.scan);
  const segments = test.looks.map((look, i) => ({ ...segment, id: i + 1, ...look }));
  const open = (): ReturnType<typeof pictureOf> => {
    const drawn = pictureOf(false);
    drawn.picture.setScan(volume, held.bricks);
    drawn.picture.setLook(lookOf(test.scan));
    drawn.picture.setCamera(lookFrom(test.scan.from, extent, viewport), extent);
    edits.showAll(drawn.picture);
    drawn.picture.setSegments(segments);
    return drawn;
  };
  const changed = (part: Partial<Changed>): Changed => ({ type: "changed", edit: 1, applied: null, voxels: [], surfaces: [], displaced: null, ...part });
  edits.add(changed({ surfaces: test.before ?? [] }), performance.now());
  edits.show(held, null);
  if (test.label !== null) {
    // no voxel has a label yet
    await edits.showLabels(1, volume, () => null);
  }
  const drawn = open();
  const before = await finished(drawn);

  const count = test.high.reduce((product, end, axis) => product * (end - (test.low[axis] ?? 0)), 1);
  const { value, label } = test;
  edits.add(
    changed({
      voxels: [
        {
          low: test.low,
          high: test.high,
          stored: value === null ? null : new Uint8Array(new Int16Array(count).fill(value).buffer),
          labels: label === null ? null : new Uint8Array(count).fill(label),
        },
      ],
      surfaces: test.surfaces ?? [],
    }),
    performance.now(),
  );
  const watched = watchUploads(drawn.gl);
  edits.show(held, drawn.picture);
  const { uploads, buffers } = watched();
  const after = await finished(drawn);
  drawn.picture.dispose();
  const again = open();
  const afresh = await finished(again);
  again.picture.dispose();
  return { before, after, afresh, uploads, buffers, complaints, milliseconds: edits.lastMilliseconds };
}

/** Notes what is sent to 3-D textures and buffers until the returned function is called. */
function watchUploads(gl: WebGL2RenderingContext): () => { uploads: number[][]; buffers: number } {
  const uploads: number[][] = [];
  let buffers = 0;
  const { texSubImage3D, bufferData } = gl;
  gl.texSubImage3D = (...call: unknown[]): void => {
    // target, level, then the box
    uploads.push(call.slice(2, 8) as number[]);
    texSubImage3D.apply(gl, call as Parameters<typeof texSubImage3D>);
  };
  gl.bufferData = (...call: unknown[]): void => {
    buffers += 1;
    (bufferData as (...call: unknown[]) => void).apply(gl, call);
  };
  return () => {
    Object.assign(gl, { texSubImage3D, bufferData });
    return { uploads, buffers };
  };
}

/** Surfaces and ray caster as the refiner drives them, for one view of the scan. */
function surfaceBench(test: MarchTest, balls: readonly SurfaceTest[], view: Camera) {
  const renderer = new THREE.WebGLRenderer({ canvas: document.createElement("canvas") });
  renderer.autoClear = false;
  renderer.info.autoReset = false;
  const volume = fieldOf(test);
  const field = new FieldTexture(volume, "rg8");
  while (!field.uploadSlab(renderer));
  const marcher = new RayMarcher();
  marcher.setField(field, brickRanges(volume));
  marcher.setLook(lookOf(test));
  const surfaces = new Surfaces(marcher, true);
  surfaces.setFrame(volume.frame);
  surfaces.setSegments(balls.map(({ look }, i) => ({ ...segment, shown_as: "surface", id: i + 1, ...look })));
  surfaces.apply(
    renderer,
    balls.map(({ centre, radius, sectors }, i) => decodeSurface(ballSurface(i + 1, centre, radius, sectors))),
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
  return { renderer, marcher, surfaces, picture, close };
}

/** Triangles that are drawn of a ball in patches, from a camera `away` mm before `target`. */
function drawnTriangles(ball: SurfaceTest, target: Vec3, away: number): number {
  const test: MarchTest = { field: "ball", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1 };
  const view = { ...lookFrom("A", outlineOf(test), viewport), target, distance: away };
  const { renderer, surfaces, picture, close } = surfaceBench(test, [ball], view);
  picture.useLevel(1);
  renderer.info.reset();
  surfaces.draw(renderer, picture, { divisor: 1, shift: [0, 0, 0], depth: 4 });
  const { triangles } = renderer.info.render;
  close();
  return triangles;
}

/** A coarse level of the picture, drawn in strips; linear RGBA, rows from the bottom. */
function coarseLevel(test: MarchTest, balls: readonly SurfaceTest[], divisor: number, strip: number): number[] {
  const view = lookFrom(test.from, outlineOf(test), viewport);
  const { renderer, marcher, surfaces, picture, close } = surfaceBench(test, balls, view);
  picture.useLevel(divisor);
  surfaces.draw(renderer, picture, { divisor, shift: [0, 0, 0], depth: 4 });
  for (let row = 0; row < picture.height; row += strip) {
    picture.useRows(row, Math.min(picture.height, row + strip));
    marcher.draw(renderer, picture, { stepsPerVoxel: test.stepsPerVoxel, jitter: false }, [0, 0, 0]);
  }
  const halves = new Uint16Array(4 * picture.width * picture.height);
  renderer.readRenderTargetPixels(picture.target, 0, 0, picture.width, picture.height, halves);
  close();
  return Array.from(halves, (half) => THREE.DataUtils.fromHalfFloat(half));
}

/** A saved picture of a size, and the same pixels of the screen before and after; RGBA bytes, rows from the top. */
async function snapshot(
  { scan: test, surfaces = [], stereo = firstStereo, behind = 0 }: ScreenTest,
  size: { readonly width: number; readonly height: number },
  transparent: boolean,
): Promise<{ readonly saved: number[]; readonly camera: Camera; readonly extent: Extent; readonly before: number[]; readonly after: number[]; readonly shares: number[] }> {
  const drawn = pictureOf(false);
  const { picture } = drawn;
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  const view = viewOf(test, extent);
  const camera = { ...view, target: addScaled(view.target, view.back, -behind), distance: view.distance + behind };
  picture.setScan(volume, bricksOf(volume, true));
  picture.setLook(lookOf(test));
  picture.setCamera(camera, extent);
  showSurfaces(picture, surfaces);
  const before = await finished(drawn);
  const context = Object.assign(document.createElement("canvas"), size).getContext("2d");
  if (context === null) {
    throw new Error("no canvas");
  }
  const shares: number[] = [];
  const { signal } = new AbortController();
  await picture.snapshot(context, { camera, size, stereo, transparent, signal, progress: (share) => shares.push(share) });
  const saved = [...context.getImageData(0, 0, size.width, size.height).data];
  const after = await finished(drawn);
  picture.dispose();
  return { saved, camera, extent, before, after, shares };
}

/** What a snapshot says that is cancelled after its first tile. */
async function cancelled(test: MarchTest): Promise<string> {
  const { picture } = pictureOf(false);
  const volume = fieldOf(test);
  const extent = outlineOf(test);
  const camera = viewOf(test, extent);
  picture.setScan(volume, bricksOf(volume, true));
  picture.setLook(lookOf(test));
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
      await picture.snapshot(context, { camera, size: { width: 400, height: 400 }, stereo: firstStereo, transparent: false, signal: aborter.signal, progress });
    }
  } catch (error) {
    return `${error instanceof Error ? error.message : String(error)} after ${String(shares.length)}`;
  } finally {
    picture.dispose();
  }
  return "not cancelled";
}

/** How many programs are linked before there is a scan, and from then until its first picture stands. */
async function programs(test: MarchTest): Promise<readonly [number, number]> {
  const { prototype } = WebGL2RenderingContext;
  const { linkProgram } = prototype;
  let links = 0;
  prototype.linkProgram = function (program): void {
    links += 1;
    linkProgram.call(this, program);
  };
  const { picture } = pictureOf(false);
  try {
    while (!picture.isPrepared) {
      await new Promise((resolve) => setTimeout(resolve, 5));
    }
    const before = links;
    const volume = fieldOf(test);
    const extent = outlineOf(test);
    picture.setScan(volume, bricksOf(volume, true));
    picture.setLook(lookOf(test));
    picture.setCamera(viewOf(test, extent), extent);
    while (!picture.hasPicture) {
      picture.advance(performance.now());
      await new Promise((resolve) => setTimeout(resolve, 5));
    }
    return [before, links - before];
  } finally {
    prototype.linkProgram = linkProgram;
    picture.dispose();
  }
}

const glTests = { programs, march, light, second, screen, show, snapshot, cancelled, resizedMiddle, edit, drawnTriangles, coarseLevel };

declare global {
  interface Window {
    glTests?: typeof glTests;
  }
}

window.glTests = glTests;
