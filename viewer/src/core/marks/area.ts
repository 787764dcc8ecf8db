/**
 * Ellipses and rectangles in a plane: regions of interest. Each is held by three points: its middle, and the ends of two
 * half axes at right angles.
 *
 * Frame: scene, LPS [mm].
 */
import { add, addScaled, cross, dot, length, normalize, scale, subtract, type Vec3 } from "../geometry/vector";

export const areaKinds = ["ellipse", "rectangle"] as const;
export type AreaKind = (typeof areaKinds)[number];

/** Directions in which an area is drawn: to the right and up in a slice, unit vectors. */
export interface AreaAxes {
  readonly right: Vec3;
  readonly up: Vec3;
}

/** Pieces of an outline: of an ellipse in all, of a rectangle on each side. */
const [ellipsePieces, sidePieces] = [48, 8] as const;
/** No half axis is shorter [mm]. */
const shortest = 0.05;

export function isArea(kind: string): kind is AreaKind {
  return areaKinds.some((each) => each === kind);
}

/** The points of the area between two opposite corners; null where there is none. The second is taken in the first's plane. */
export function areaBetween(corner: Vec3, opposite: Vec3, { right, up }: AreaAxes): readonly Vec3[] | null {
  const across = subtract(opposite, corner);
  const [x, y] = [dot(across, right) / 2, dot(across, up) / 2];
  if (Math.min(Math.abs(x), Math.abs(y)) < shortest) {
    return null;
  }
  const middle = addScaled(addScaled(corner, right, x), up, y);
  return [middle, addScaled(middle, right, Math.abs(x)), addScaled(middle, up, Math.abs(y))];
}

/** An area of which one point is dragged: its middle takes all along, an end changes the length of its half axis. */
export function draggedArea(points: readonly Vec3[], index: number, to: Vec3): readonly Vec3[] {
  const [middle, ...ends] = points;
  const held = points[index];
  if (middle === undefined || held === undefined) {
    return points;
  }
  if (index === 0) {
    const moved = subtract(to, middle);
    return [to, ...ends.map((end) => add(end, moved))];
  }
  const direction = normalize(subtract(held, middle));
  const reach = Math.max(shortest, dot(subtract(to, middle), direction));
  return points.map((point, i) => (i === index ? addScaled(middle, direction, reach) : point));
}

/** Its size [mm²]; 0 while points are missing. */
export function areaSize(kind: AreaKind, [middle, first, second]: readonly Vec3[]): number {
  if (middle === undefined || first === undefined || second === undefined) {
    return 0;
  }
  const square = length(cross(subtract(first, middle), subtract(second, middle)));
  return square * (kind === "ellipse" ? Math.PI : 4);
}

/** Points around it, of which the last is not the first again; what is no area is returned as it is. */
export function areaOutline(kind: AreaKind, points: readonly Vec3[]): readonly Vec3[] {
  const [middle, first, second] = points;
  if (middle === undefined || first === undefined || second === undefined) {
    return points;
  }
  const [u, v] = [subtract(first, middle), subtract(second, middle)];
  return sharesAround(kind).map(([a, b]) => add(middle, add(scale(u, a), scale(v, b))));
}

/** Shares of both half axes, around. */
function sharesAround(kind: AreaKind): readonly (readonly [number, number])[] {
  if (kind === "ellipse") {
    return Array.from({ length: ellipsePieces }, (_, i) => {
      const angle = (2 * Math.PI * i) / ellipsePieces;
      return [Math.cos(angle), Math.sin(angle)] as const;
    });
  }
  const corners = [[1, 1], [-1, 1], [-1, -1], [1, -1]] as const;
  return corners.flatMap(([x, y], i) => {
    const [nextX, nextY] = corners[(i + 1) % 4] ?? corners[0];
    return Array.from({ length: sidePieces }, (_, piece) => {
      const share = piece / sidePieces;
      return [x + (nextX - x) * share, y + (nextY - y) * share] as const;
    });
  });
}
