import { expect, test } from "vitest";
import { extentOf, lookFrom } from "../../../src/core/geometry/camera";
import {
  faceMiddle,
  facesOf,
  flipped,
  keptCorners,
  keptSpan,
  mostFreePlanes,
  nothingClipped,
  outward,
  planeAcross,
  planesOf,
  saneClip,
  withCut,
  type Clip,
  type Plane,
} from "../../../src/core/view/clip";
import { draggedAlong } from "../../../src/core/view/gizmo";
import { frameOf } from "../../../src/core/scan/scan_volume";
import { addScaled, dot, normalize, rotateAbout, subtract, type Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";
import { pickSurface } from "../../../src/core/picking/pick_surface";
import { firstLighting } from "../../../src/core/appearance/appearance";
import { shadedOptics } from "../../../src/core/appearance/optics";
import { scanOf, volumeOf } from "../../support/volumes";

const scan = scanOf([40, 50, 30], [1, 0.5, 2], [10, -30, 500]);
const frame = frameOf(scan);

/** A scan whose first axis goes to the back, whose second to the right, turned a little. */
function turnedFrame(): ReturnType<typeof frameOf> {
  const turn = (v: Vec3): Vec3 => rotateAbout(v, normalize([0.3, 0.5, 1]), 0.3);
  const [x, y, z] = [turn([0, 1, 0]), turn([-1, 0, 0]), turn([0, 0, -2])];
  const rows = ([0, 1, 2] as const).flatMap((row) => [x[row], y[row], z[row], 100]);
  return frameOf({ ...scan, patient_from_grid: [...rows, 0, 0, 0, 1] });
}

test("faces are named by the directions of the body that they look toward, each once", () => {
  for (const one of [frame, turnedFrame()]) {
    const faces = facesOf(one);
    expect(faces.map(({ letter }) => letter)).toEqual(["R", "L", "A", "P", "I", "S"]);
    const toward = { R: [-1, 0, 0], L: [1, 0, 0], A: [0, -1, 0], P: [0, 1, 0], I: [0, 0, -1], S: [0, 0, 1] } as const;
    for (const face of faces) {
      expect(dot(outward(one, face), toward[face.letter])).toBeGreaterThan(0.8);
    }
    expect(new Set(faces.map(({ axis, side }) => `${String(axis)}${side}`)).size).toBe(6);
  }
});

test("a box keeps the points inside of its corners and no others", () => {
  for (const one of [frame, turnedFrame()]) {
    const box = facesOf(one).reduce((before, face, i) => withCut(before, one, face, 2 + i), {
      ...nothingClipped.box,
      on: true,
    });
    const planes = planesOf({ box, planes: [] }, one);
    expect(planes).toHaveLength(6);
    const kept = (point: Vec3): boolean => planes.every(({ normal, offset }) => dot(normal, point) <= offset + 1e-9);
    const corners = keptCorners(box, one);
    expect(corners.every(kept)).toBe(true);
    for (const face of facesOf(one)) {
      const at = faceMiddle(box, one, face);
      expect(kept(at)).toBe(true);
      expect(kept(addScaled(at, outward(one, face), 0.01))).toBe(false);
    }
  }
});

test("faces never pass one another: a voxel is left", () => {
  const faces = facesOf(frame);
  const [right, left] = [faces[0], faces[1]];
  if (right === undefined || left === undefined) throw new Error("no faces");
  const box = withCut(withCut(nothingClipped.box, frame, right, 30), frame, left, 1000);
  expect(box.low[0] + box.high[0]).toBe(39);
  expect(withCut(box, frame, left, -5).high[0]).toBe(0);
});

test("a ray is kept where all of its points are behind all planes", () => {
  const random = new Random(5);
  for (let i = 0; i < 200; ++i) {
    const planes: Plane[] = Array.from({ length: 4 }, () => ({
      normal: normalize(random.vector(1)),
      offset: random.between(-5, 20),
    }));
    const ray = { origin: random.vector(30), direction: normalize(random.vector(1)) };
    const [enter, leave] = keptSpan(planes, ray);
    for (let t = 0; t < 60; t += 0.37) {
      const point = addScaled(ray.origin, ray.direction, t);
      const most = Math.max(...planes.map(({ normal, offset }) => dot(normal, point) - offset));
      if (Math.abs(most) > 1e-9) {
        expect(enter <= t && t <= leave).toBe(most < 0);
      }
    }
  }
});

test("a plane across the view cuts away what stands before it, flipped what is behind", () => {
  const camera = lookFrom("L", extentOf([[0, 0, 0], [100, 80, 60]]), { width: 300, height: 200 });
  const plane = planeAcross(camera);
  const before = addScaled(camera.target, camera.back, 3);
  expect(dot(plane.normal, before)).toBeGreaterThan(plane.offset);
  expect(dot(flipped(plane).normal, before)).toBeLessThan(flipped(plane).offset);
});

test("a clip that was kept comes back, and what is none becomes one", () => {
  const clip: Clip = {
    box: { on: true, low: [1, 2, 3], high: [0, 1, 0] },
    planes: [{ normal: [0, 1, 0], offset: 12, on: false }],
  };
  expect(saneClip(JSON.parse(JSON.stringify(clip)), frame)).toEqual(clip);
  const broken = [
    null,
    3,
    {},
    { box: { on: true, low: [1, 2], high: "x" } },
    { planes: [{ normal: [0, 2, 0], offset: 1, on: true }, 5] },
  ];
  for (const given of broken) {
    expect(saneClip(given, frame)).toEqual(nothingClipped);
  }
  const many = Array.from({ length: 20 }, () => clip.planes[0]);
  expect(saneClip({ ...clip, planes: many }, frame).planes).toHaveLength(mostFreePlanes);
  // a box of a larger scan is cut down to this one
  const { box } = saneClip({ box: { on: true, low: [1e6, 0, 0], high: [1e6, 0, 0] } }, frame);
  expect(box.low[0] + box.high[0]).toBeLessThan(40);
});

test("a handle that is dragged follows the mouse on the screen, or goes in depth where it looks at the viewer", () => {
  const viewport = { width: 300, height: 200 };
  const eye = { camera: lookFrom("A", extentOf([[0, 0, 0], [100, 80, 60]]), viewport), viewport };
  const at: Vec3 = [50, 40, 30];
  const pixel = draggedAlong(at, [1, 0, 0], [1, 0], eye);
  expect(draggedAlong(at, [-1, 0, 0], [10, 0], eye)).toBeCloseTo(-10 * pixel, 3);
  expect(draggedAlong(at, [0, 0, 1], [0, -10], eye)).toBeCloseTo(10 * pixel, 3);
  // the anterior face looks at the viewer: upward pushes it away
  expect(draggedAlong(at, [0, -1, 0], [0, -10], eye)).toBeLessThan(-5 * pixel);
});

test("what is cut away cannot be picked, the cut face can", () => {
  const volume = volumeOf(scanOf([40, 40, 40], [1, 1, 1]), () => 100);
  const appearance = {
    transferFunction: {
      points: [
        { value: -500, colour: [1, 1, 1] as const, extinction: 50 },
        { value: 500, colour: [1, 1, 1] as const, extinction: 50 },
      ],
    },
    ranges: [],
    edgeGradient: 40,
    lighting: { ...firstLighting, edges: 0 },
    optics: shadedOptics,
  };
  const ray = { origin: [20, -50, 20] as const, direction: [0, 1, 0] as const };
  const crossings = [{ t: 55, id: 7, opacity: 1 }];
  const pick = (clip: readonly Plane[]): ReturnType<typeof pickSurface> =>
    pickSurface(volume, appearance, ray, { crossings, labelAt: () => null, clip });
  const front: Plane = { normal: [0, -1, 0], offset: -15 };
  expect(pick([])?.point[1]).toBeLessThan(1);
  expect(pick([front])?.segment).toBeNull();
  expect(Math.abs((pick([front])?.point[1] ?? 0) - 15)).toBeLessThan(0.6);
  // all is cut away
  expect(pick([{ normal: [0, 1, 0], offset: -5 }])).toBeNull();
  expect(subtract(pick([])?.point ?? [0, 0, 0], [20, 0, 20])[0]).toBe(0);
});
