/**
 * Where the body stands in a scan, so that air around it does not make it small on the screen.
 */
import { brickEdge, type BrickRanges } from "./bricks";
import { dot, type Vec3 } from "../geometry/vector";

/** Directions in which the farthest brick is looked for. */
const directionCount = 96;

/**
 * Points of the grid around all bricks that hold something: the outermost in many directions.
 *
 * @param step voxels per stored value.
 * @param metric size of a voxel [mm], so that directions are those of the body.
 * @returns at least one point; the whole scan's corners where no brick holds anything.
 */
export function contentHull(
  bricks: BrickRanges,
  step: number,
  metric: Vec3,
  holds: (low: number, high: number) => boolean,
): Vec3[] {
  const { counts, low, high } = bricks;
  const directions = evenDirections(directionCount);
  const farthest = directions.map(() => -Infinity);
  const points: Vec3[] = [];
  const edge = brickEdge * step;
  let i = 0;
  for (let z = 0; z < counts[2]; ++z) {
    for (let y = 0; y < counts[1]; ++y) {
      for (let x = 0; x < counts[0]; ++x, ++i) {
        if (!holds(low[i] ?? 0, high[i] ?? 0)) {
          continue;
        }
        const centre: Vec3 = [(x + 0.5) * edge, (y + 0.5) * edge, (z + 0.5) * edge];
        const inMm: Vec3 = [centre[0] * metric[0], centre[1] * metric[1], centre[2] * metric[2]];
        directions.forEach((direction, d) => {
          const reach = dot(direction, inMm);
          if (reach > (farthest[d] ?? 0)) {
            farthest[d] = reach;
            points[d] = centre;
          }
        });
      }
    }
  }
  return points.length > 0 ? points : cornersOfBricks(counts, edge);
}

/** Unit vectors spread over the sphere (Fibonacci lattice; Álvaro González 2010). */
function evenDirections(count: number): Vec3[] {
  const golden = Math.PI * (3 - Math.sqrt(5));
  return Array.from({ length: count }, (_, i) => {
    const z = 1 - (2 * i + 1) / count;
    const radius = Math.sqrt(1 - z * z);
    return [radius * Math.cos(golden * i), radius * Math.sin(golden * i), z];
  });
}

function cornersOfBricks(counts: Vec3, edge: number): Vec3[] {
  return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [
    i & 1 ? counts[0] * edge : 0,
    i & 2 ? counts[1] * edge : 0,
    i & 4 ? counts[2] * edge : 0,
  ]);
}
