import { expect, test } from "vitest";
import { shifted, turned, unmoved } from "../../../src/core/geometry/object_pose";
import { firstLighting } from "../../../src/core/appearance/appearance";
import { shadedOptics } from "../../../src/core/appearance/optics";
import { surfaceCrossings, throughTriangle, type DrawnSurface } from "../../../src/core/picking/pick_patches";
import { pickSurface } from "../../../src/core/picking/pick_surface";
import { defaultSoftTissueAndBone, transferFunctionOf } from "../../../src/core/appearance/soft_tissue_and_bone";
import { shownRanges } from "../../../src/core/segments/shown_segments";
import { decodeSurface } from "../../../src/core/surfaces/surface_patches";
import { addScaled, distance, normalize, type Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";
import { ballSurface } from "../../support/ball_surface";
import { scanOf, segment, volumeOf } from "../../support/volumes";

const centre: Vec3 = [34, -6, 524];
const radius = 6;
/** Of a ball of 32 rings: the middles of its faces are nearer to the centre than its vertices. */
const facet = radius * (1 - Math.cos(Math.PI / 32) ** 2) + 1e-3;

function ball(id: number, pose = unmoved, opacity = 1): DrawnSurface {
  return { id, pose, opacity, patches: decodeSurface(ballSurface(id, centre, radius, 4)).patches };
}

test("a ray through a moved surface crosses it where it stands, in front and behind", () => {
  const random = new Random(5);
  for (let i = 0; i < 50; ++i) {
    const shift: Vec3 = [random.between(-80, 80), random.between(-80, 80), random.between(-80, 80)];
    const pose = shifted(turned(unmoved, centre, normalize(random.vector(1)), random.between(-3, 3)), shift);
    const middle: Vec3 = [centre[0] + shift[0], centre[1] + shift[1], centre[2] + shift[2]];
    const direction = normalize(random.vector(1));
    const origin = addScaled(middle, direction, -40);
    const crossings = surfaceCrossings([ball(3, pose)], { origin, direction });
    const [first, last] = [crossings[0]?.t ?? 0, crossings.at(-1)?.t ?? 0];
    expect(Math.abs(first - (40 - radius))).toBeLessThan(facet);
    expect(Math.abs(last - (40 + radius))).toBeLessThan(facet);
    expect(crossings[0]?.id).toBe(3);
    // where the scan has it there is nothing any more
    if (distance(middle, centre) > 3 * radius) {
      expect(
        surfaceCrossings([ball(3, pose)], { origin: addScaled(centre, direction, 2 * radius), direction: [0, 0, 0] }),
      ).toEqual([]);
    }
  }
});

test("a triangle is met from both sides, and not beside it, behind the eye, or along its plane", () => {
  const [a, b, c]: [Vec3, Vec3, Vec3] = [[0, 0, 5], [4, 0, 5], [0, 4, 5]];
  expect(throughTriangle([1, 1, 0], [0, 0, 1], a, b, c)).toBe(5);
  expect(throughTriangle([1, 1, 9], [0, 0, -2], a, b, c)).toBe(2);
  expect(throughTriangle([3, 3, 0], [0, 0, 1], a, b, c)).toBeNull();
  expect(throughTriangle([1, 1, 9], [0, 0, 1], a, b, c)).toBeNull();
  expect(throughTriangle([-5, 1, 5], [1, 0, 0], a, b, c)).toBeNull();
  expect(throughTriangle([1, 1, 0], [Number.NaN, 0, 1], a, b, c)).toBeNull();
});

// a slab of bone in air behind y = 0, a surface before it, in it, and beside the scan
const scan = scanOf([48, 48, 24], [1, 1, 2], [10, -30, 500]);
const volume = volumeOf(scan, ([, y]) => (y > 30 ? 1000 : -1000));
const appearance = {
  transferFunction: transferFunctionOf(defaultSoftTissueAndBone({ softTissue: 40, bone: 250 })),
  ranges: shownRanges([segment], scan),
  edgeGradient: 40,
  lighting: firstLighting,
  optics: shadedOptics,
};

function pick(
  surfaces: readonly DrawnSurface[],
  from: Vec3,
  direction: Vec3 = [0, 1, 0],
): ReturnType<typeof pickSurface> {
  const ray = { origin: from, direction };
  return pickSurface(volume, appearance, ray, {
    crossings: surfaceCrossings(surfaces, ray),
    labelAt: () => null,
    clip: [],
  });
}

test("whatever is seen first is picked: a surface before the scan, the scan before a surface", () => {
  const eye: Vec3 = [34, -100, 524];
  const before = pick([ball(3, shifted(unmoved, [0, -10, 0]))], eye);
  expect(before?.segment).toBe(3);
  expect(before?.point[1]).toBeCloseTo(centre[1] - 10 - radius, 1);
  const behind = pick([ball(3, shifted(unmoved, [0, 20, 0]))], eye);
  expect(behind?.segment).toBe(1);
  expect(Math.abs(behind?.point[1] ?? 100)).toBeLessThan(1);
});

test("a surface beside the scan is picked too, and one that is more clear than opaque is seen through", () => {
  const aside = shifted(unmoved, [200, 0, 0]);
  const eye: Vec3 = [234, -100, 524];
  expect(pick([ball(3, aside)], eye)?.segment).toBe(3);
  expect(pick([], eye)).toBeNull();
  // its near and its far side leave 0.81 of what is behind
  expect(pick([ball(3, unmoved, 0.1)], [34, -100, 524])?.segment).toBe(1);
  // with both sides less than half is left
  expect(pick([ball(3, unmoved, 0.4)], [34, -100, 524])?.segment).toBe(3);
});

test("a labelled segment is picked by its labels, a hidden one is seen through", () => {
  const ray = { origin: [34, -100, 524] as Vec3, direction: [0, 1, 0] as Vec3 };
  const labelAt = (visible: boolean) => ([, y]: Vec3) => (y > 10 && y < 20 ? { id: 7, visible } : null);
  const picked = pickSurface(volume, appearance, ray, { crossings: [], labelAt: labelAt(true), clip: [] });
  expect(picked?.segment).toBe(7);
  expect(Math.abs((picked?.point[1] ?? 0) - -20)).toBeLessThan(1);
  expect(pickSurface(volume, appearance, ray, { crossings: [], labelAt: labelAt(false), clip: [] })?.segment).toBe(1);
});
