import { expect, test } from "vitest";
import {
  alongView,
  nearAndFar,
  depthOf,
  extentOf,
  eyeOf,
  firstView,
  frame,
  inProjection,
  lookFrom,
  orbit,
  pan,
  pixelSizeAt,
  project,
  rayThrough,
  saneCamera,
  vantage,
  zoom,
  type Camera,
} from "../../../src/core/geometry/camera";
import { add, addScaled, cross, distance, dot, length, subtract, type Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";

const viewport = { width: 900, height: 700 };
const box: Vec3[] = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? 200 : 0, i & 2 ? 150 : 30, i & 4 ? 260 : 10]);
const extent = extentOf(box);

function randomView(random: Random): Camera {
  const turned = orbit(firstView(extent, viewport), random.between(-4, 4), random.between(-4, 4));
  return zoom(turned, random.between(0.3, 2), extent);
}

test("from before, the patient's left is at the right and the head is up", () => {
  const camera = lookFrom("A", extent, viewport);
  expect(distance(camera.right, [1, 0, 0]) + distance(camera.up, [0, 0, 1])).toBe(0);
  expect(eyeOf(camera)[1]).toBeLessThan(extent.centre[1]);
});

test("from the feet, as radiologists look, anterior is up and the patient's left at the right", () => {
  const camera = lookFrom("I", extent, viewport);
  expect(camera.right[0]).toBeCloseTo(1);
  expect(camera.up[1]).toBeCloseTo(-1);
});

test("axes stay a right-handed orthonormal frame through any turning", () => {
  let camera = firstView(extent, viewport);
  const random = new Random(2);
  for (let i = 0; i < 2000; ++i) {
    camera = orbit(camera, random.between(-0.3, 0.3), random.between(-0.3, 0.3));
  }
  const { right, up, back } = camera;
  // 4000 turns of rounding 1e-16 each
  expect(distance(cross(right, up), back)).toBeLessThan(1e-10);
  expect(Math.abs(dot(right, up)) + Math.abs(length(up) - 1)).toBeLessThan(1e-10);
});

test("turning keeps the horizon level: the body's axis stays vertical in the picture", () => {
  const random = new Random(3);
  for (let i = 0; i < 100; ++i) {
    expect(Math.abs(randomView(random).right[2])).toBeLessThan(1e-12);
  }
});

test("dragging to the right turns what is in front to the right, downward shows the top", () => {
  const camera = lookFrom("A", extent, viewport);
  const front: Vec3 = addScaled(extent.centre, camera.back, 50);
  const before = project(camera, front, viewport) ?? [0, 0];
  const afterRight = project(orbit(camera, 0.2, 0), front, viewport) ?? [0, 0];
  const afterDown = project(orbit(camera, 0, 0.2), front, viewport) ?? [0, 0];
  expect(afterRight[0]).toBeGreaterThan(before[0]);
  expect(afterDown[1]).toBeGreaterThan(before[1]);
});

test("the ray through the picture of a point passes through the point", () => {
  const random = new Random(4);
  for (let i = 0; i < 300; ++i) {
    const camera = randomView(random);
    const point = add(extent.centre, random.vector(60));
    const place = project(camera, point, viewport);
    if (place === null) {
      continue;
    }
    const ray = rayThrough(camera, place[0], place[1], viewport);
    const offset = subtract(point, ray.origin);
    // rounding at distances of some hundred mm
    expect(length(cross(offset, ray.direction))).toBeLessThan(1e-9);
    expect(dot(offset, ray.direction)).toBeGreaterThan(0);
  }
});

test("framing shows the whole content and fills the picture with it", () => {
  const random = new Random(5);
  for (let i = 0; i < 100; ++i) {
    const camera = frame(randomView(random), extent, viewport);
    const places = box.map((corner) => project(camera, corner, viewport) ?? [NaN, NaN]);
    const reach = Math.max(...places.map(([x, y]) => Math.max(Math.abs(x / 450 - 1), Math.abs(y / 350 - 1))));
    expect(reach).toBeLessThanOrEqual(1);
    // perspective makes the near side larger than the framing assumes for the far side
    expect(reach).toBeGreaterThan(0.75);
  }
});

test("a move in the view by pixels moves the picture of the point by these pixels", () => {
  const random = new Random(6);
  for (let i = 0; i < 100; ++i) {
    const camera = randomView(random);
    const point = add(extent.centre, random.vector(40));
    const before = project(camera, point, viewport) ?? [NaN, NaN];
    const after = project(camera, add(point, alongView(camera, 12, -7, point, viewport)), viewport) ?? [NaN, NaN];
    expect(after[0] - before[0]).toBeCloseTo(12, 6);
    expect(after[1] - before[1]).toBeCloseTo(-7, 6);
  }
});

test("panning takes the target's picture along with the mouse", () => {
  const camera = firstView(extent, viewport);
  const before = project(camera, camera.target, viewport) ?? [NaN, NaN];
  const after = project(pan(camera, 30, 20, viewport), camera.target, viewport) ?? [NaN, NaN];
  expect(after[0] - before[0]).toBeCloseTo(30, 6);
  expect(after[1] - before[1]).toBeCloseTo(20, 6);
});

test("near and far planes hold all content, and near stays before the eye", () => {
  const random = new Random(7);
  for (let i = 0; i < 200; ++i) {
    const camera = randomView(random);
    const { near, far } = nearAndFar(camera, extent);
    expect(near).toBeGreaterThan(0);
    for (const corner of box) {
      const depth = depthOf(camera, corner);
      expect(depth).toBeLessThan(far);
      if (depth > far / 1000) {
        expect(depth).toBeGreaterThan(near);
      }
    }
  }
});

test("zooming stops at sensible distances", () => {
  const camera = firstView(extent, viewport);
  expect(zoom(camera, 1e-9, extent).distance).toBeGreaterThan(1);
  expect(zoom(camera, 1e9, extent).distance).toBeLessThan(100 * extent.radius);
});

function randomOrthographic(random: Random): Camera {
  return pan(
    inProjection(randomView(random), true, extent),
    random.between(-80, 80),
    random.between(-80, 80),
    viewport,
  );
}

test("orthographic: all rays are parallel, and those through the picture of a point pass through it", () => {
  const random = new Random(41);
  for (let i = 0; i < 300; ++i) {
    const camera = randomOrthographic(random);
    const point = add(extent.centre, random.vector(120));
    const [x, y] = project(camera, point, viewport) ?? [NaN, NaN];
    const { origin, direction } = rayThrough(camera, x, y, viewport);
    expect(distance(direction, addScaled([0, 0, 0], camera.back, -1))).toBeLessThan(1e-12);
    const along = dot(subtract(point, origin), direction);
    // nothing that is shown lies behind where rays begin
    expect(along).toBeGreaterThan(0);
    expect(distance(addScaled(origin, direction, along), point)).toBeLessThan(1e-8);
  }
});

test("orthographic: a pixel is as large at any depth, and as in perspective at the target", () => {
  const random = new Random(42);
  for (let i = 0; i < 100; ++i) {
    const camera = randomView(random);
    const flat = inProjection(camera, true, extent);
    const size = pixelSizeAt(camera, camera.target, viewport);
    for (const away of [-300, 0, 200]) {
      expect(pixelSizeAt(flat, addScaled(camera.target, camera.back, away), viewport)).toBeCloseTo(size, 10);
    }
    expect(inProjection(flat, false, extent)).toEqual(camera);
  }
});

test("orthographic: a move along the view is one of as many pixels", () => {
  const random = new Random(43);
  for (let i = 0; i < 100; ++i) {
    const camera = randomOrthographic(random);
    const point = add(extent.centre, random.vector(100));
    const [x, y] = project(camera, point, viewport) ?? [NaN, NaN];
    const [toX, toY] = project(camera, add(point, alongView(camera, 17, -9, point, viewport)), viewport) ?? [NaN, NaN];
    expect(toX - x).toBeCloseTo(17, 8);
    expect(toY - y).toBeCloseTo(-9, 8);
  }
});

test("orthographic: framing shows all of the content, and near and far hold it", () => {
  const random = new Random(44);
  for (let i = 0; i < 50; ++i) {
    const camera = frame(randomOrthographic(random), extent, viewport);
    const places = extent.outline.map((point) => project(camera, point, viewport) ?? [NaN, NaN]);
    const shares = places.map(([x, y]) =>
      Math.max(Math.abs((2 * x) / viewport.width - 1), Math.abs((2 * y) / viewport.height - 1)),
    );
    expect(Math.max(...shares)).toBeCloseTo(0.9, 8);
    const { near, far } = nearAndFar(camera, extent);
    for (const point of extent.outline) {
      expect(depthOf(camera, point)).toBeGreaterThan(near);
      expect(depthOf(camera, point)).toBeLessThan(far);
    }
  }
});

test("from the vantage point things stand behind one another as in the picture", () => {
  const random = new Random(45);
  const camera = randomOrthographic(random);
  for (let i = 0; i < 50; ++i) {
    const { origin, direction } = rayThrough(camera, random.between(0, 900), random.between(0, 700), viewport);
    const seen = (point: Vec3): Vec3 => {
      const way = subtract(point, vantage(camera));
      return addScaled([0, 0, 0], way, 1 / length(way));
    };
    const from = addScaled(origin, direction, 600);
    const to = addScaled(origin, direction, 1100);
    // a radian of 1e-7 is a micrometre on 10 m
    expect(distance(seen(from), seen(to))).toBeLessThan(1e-7);
  }
});

test("a camera that was kept keeps its projection; older ones are in perspective", () => {
  const flat = inProjection(firstView(extent, viewport), true, extent);
  expect(saneCamera(JSON.parse(JSON.stringify(flat)))).toEqual(flat);
  const older: Partial<Camera> = { ...flat };
  delete (older as { parallel?: unknown }).parallel;
  expect(saneCamera(older)?.parallel).toBeNull();
  expect(saneCamera({ ...flat, parallel: -3 })).toBeNull();
});
