/**
 * Where a segment stands: poses as they are sent, row-major 4×4, from the scan to the scene [mm].
 * The numbers of a pose are those about the segment's middle, so that turning does not shift it.
 */
import { transformPoint, transformVector } from "./affine";
import type { Pose, Segment } from "../protocol";
import { add, addScaled, dot, normalize, rotateAbout, scale, subtract, type Vec3 } from "./vector";

/** Where the scan has it. */
export const unmoved: Pose = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** A pose in numbers that a person reads. */
export interface PoseNumbers {
  /** Way of the middle along L, P, S [mm]. */
  readonly translation: Vec3;
  /** Turns about L, then P, then S, axes of the scene [degrees]. */
  readonly rotation: Vec3;
}

const degree = Math.PI / 180;
const axes: readonly [Vec3, Vec3, Vec3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/** Middle of the segment's box where the scan has it [mm]; null where it is empty. */
export function middleOf({ bounds, grid }: Segment, sceneFromGrid: readonly number[]): Vec3 | null {
  if (bounds === null) {
    return null;
  }
  return transformPoint(grid ?? sceneFromGrid, scale(add(bounds[0], bounds[1]), 0.5));
}

/** Corners of the segment's box where the scan has it [mm]; the bits of a place say low or high. */
export function cornersOf(
  { bounds, grid }: Pick<Segment, "bounds" | "grid">,
  sceneFromGrid: readonly number[],
): readonly Vec3[] {
  if (bounds === null) {
    return [];
  }
  return [0, 1, 2, 3, 4, 5, 6, 7].map((place) => {
    const along = (axis: 0 | 1 | 2): number => bounds[(place >> axis) & 1 ? 1 : 0][axis];
    return transformPoint(grid ?? sceneFromGrid, [along(0), along(1), along(2)]);
  });
}

/** Edges of such a box, as places of two corners. */
export const boxEdges: readonly (readonly [number, number])[] = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((place) =>
  [1, 2, 4].filter((bit) => (place & bit) === 0).map((bit) => [place, place | bit] as const),
);

/** The pose after a shift [mm]. */
export function shifted(pose: Pose, by: Vec3): Pose {
  return fromColumns(columnsOf(pose), add(originOf(pose), by));
}

/** The pose after a turn about a unit axis through a point of the scene [rad]. */
export function turned(pose: Pose, centre: Vec3, axis: Vec3, angle: number): Pose {
  const columns = columnsOf(pose).map((column) => rotateAbout(column, axis, angle));
  const origin = add(centre, rotateAbout(subtract(originOf(pose), centre), axis, angle));
  return fromColumns(straightened(columns), origin);
}

/** The pose in numbers, for a segment with this middle. */
export function numbersOf(pose: Pose, middle: Vec3): PoseNumbers {
  const [x, y] = columnsOf(pose) as [Vec3, Vec3];
  const z = columnsOf(pose)[2] ?? [0, 0, 1];
  // columns of Rz(c) Ry(b) Rx(a)
  const b = Math.asin(Math.min(1, Math.max(-1, -x[2])));
  const level = Math.cos(b) > 1e-9;
  const a = level ? Math.atan2(y[2], z[2]) : Math.atan2(-z[1], y[1]);
  const c = level ? Math.atan2(x[1], x[0]) : 0;
  return {
    translation: subtract(transformPoint(pose, middle), middle),
    rotation: scale([a, b, c], 1 / degree),
  };
}

/** The pose that these numbers mean. */
export function poseOf({ translation, rotation }: PoseNumbers, middle: Vec3): Pose {
  const pose = axes.reduce(
    (before, axis, place) => turned(before, middle, axis, (rotation[place] ?? 0) * degree),
    unmoved,
  );
  return shifted(pose, translation);
}

/** How far two poses put the points of a box apart, at most [mm]. */
export function apart(a: Pose, b: Pose, corners: readonly Vec3[]): number {
  return Math.max(
    0,
    ...corners.map((corner) => Math.hypot(...subtract(transformPoint(a, corner), transformPoint(b, corner)))),
  );
}

function columnsOf(pose: Pose): readonly Vec3[] {
  return axes.map((axis) => transformVector(pose, axis));
}

function originOf(pose: Pose): Vec3 {
  return transformPoint(pose, [0, 0, 0]);
}

/** Axes at right angles again, after rounding. */
function straightened(columns: readonly Vec3[]): readonly Vec3[] {
  const straight: Vec3[] = [];
  for (const column of columns) {
    const across = straight.reduce((rest, other) => addScaled(rest, other, -dot(rest, other)), column);
    straight.push(normalize(across));
  }
  return straight;
}

function fromColumns(columns: readonly Vec3[], origin: Vec3): Pose {
  const rows = ([0, 1, 2] as const).flatMap((row) => [...columns.map((column) => column[row]), origin[row]]);
  return [...rows, 0, 0, 0, 1];
}
