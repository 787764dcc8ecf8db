/**
 * The surface that a cut goes along: a painted line, carried on where it is open, and drawn into the depth along the
 * lines of sight, as far as the segment reaches. Frame: scene [mm].
 */
import { add, addScaled, distance, dot, normalize, scale, subtract, type Vec3 } from "../geometry/vector";

/** A line that was painted, as points of the scene under it and the eye that saw it. */
export interface SeenLine {
  readonly points: readonly Vec3[];
  readonly eye: Vec3;
  /** Direction of view. */
  readonly view: Vec3;
  readonly closed: boolean;
}

/** A strip: pairs of a nearer and a farther point, along the line. */
export type CutSheet = readonly (readonly [near: Vec3, far: Vec3])[];

/** The sheet reaches beyond the segment by this share of its radius. */
const beyond = 1.15;

/** The sheet through a segment. @param corners of its box where it stands, at least one. */
export function cutSheet(line: SeenLine, corners: readonly Vec3[]): CutSheet {
  const { eye, view, closed } = line;
  const centre = scale(corners.reduce(add), 1 / corners.length);
  const radius = beyond * Math.max(...corners.map((corner) => distance(corner, centre)));
  const middle = dot(subtract(centre, eye), view);
  // each at the depth of the segment's middle, where the line seems to lie
  const atDepth = (point: Vec3, depth: number): Vec3 => {
    const way = subtract(point, eye);
    return addScaled(eye, way, depth / dot(way, view));
  };
  const points = line.points.map((point) => atDepth(point, middle));
  const ends = closed ? [...points, ...points.slice(0, 1)] : carriedOn(points, centre, radius);
  // no nearer than the eye
  const nearest = Math.max(middle - radius, 0.02 * middle);
  return ends.map((point) => [atDepth(point, nearest), atDepth(point, middle + radius)] as const);
}

/** An open line, straight on beyond both ends as far as a ball reaches. */
function carriedOn(points: readonly Vec3[], centre: Vec3, radius: number): readonly Vec3[] {
  const onward = (end: Vec3 | undefined, before: Vec3 | undefined): readonly Vec3[] => {
    if (end === undefined || before === undefined) {
      return [];
    }
    const way = normalize(subtract(end, before));
    const from = subtract(end, centre);
    const along = dot(from, way);
    const inside = along * along + radius * radius - dot(from, from);
    const ahead = inside > 0 ? Math.sqrt(inside) - along : 0;
    return ahead > 0 ? [addScaled(end, way, ahead)] : [];
  };
  return [...onward(points[0], points[1]), ...points, ...onward(points.at(-1), points.at(-2))];
}
