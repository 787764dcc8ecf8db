/** The surface of a ball in patches, as the engine would send it. */
import type { SegmentSurface, SurfacePatch } from "../../src/core/protocol";
import { addScaled, type Vec3 } from "../../src/core/geometry/vector";

/**
 * A ball cut into sectors about the z axis, each a patch with a box of its own [mm].
 *
 * @param rings from pole to pole; there are twice as many columns around all of it.
 */
export function ballSurface(id: number, centre: Vec3, radius: number, sectors: number, rings = 32): SegmentSurface {
  const patches = Array.from({ length: sectors }, (_, i) => sectorOf(centre, radius, i, sectors, rings));
  return { id, whole: true, dropped: [], patches };
}

/** Outward unit normal at a ring and a column. */
function normalAt(ring: number, column: number, rings: number): Vec3 {
  const [polar, around] = [(Math.PI * ring) / rings, (Math.PI * column) / rings];
  return [Math.sin(polar) * Math.cos(around), Math.sin(polar) * Math.sin(around), Math.cos(polar)];
}

function sectorOf(centre: Vec3, radius: number, sector: number, sectors: number, rings: number): SurfacePatch {
  const width = (2 * rings) / sectors;
  const normals: Vec3[] = [];
  const triangles: number[] = [];
  for (let ring = 0; ring <= rings; ++ring) {
    for (let column = 0; column <= width; ++column) {
      const here = normals.length;
      // the last column is the first again, to the bit
      normals.push(normalAt(ring, (sector * width + column) % (2 * rings), rings));
      if (ring < rings && column < width) {
        const below = here + width + 1;
        triangles.push(here, below, here + 1, here + 1, below, below + 1);
      }
    }
  }
  return patchOf([sector, 0, 0], normals.map((normal) => addScaled(centre, normal, radius)), normals, triangles);
}

/** Packs a patch; its box is the smallest around its vertices. */
export function patchOf(
  index: Vec3,
  points: readonly Vec3[],
  normals: readonly Vec3[],
  triangles: readonly number[],
): SurfacePatch {
  const along = (axis: 0 | 1 | 2): number[] => points.map((point) => point[axis]);
  const lower = (axis: 0 | 1 | 2): number => Math.min(...along(axis));
  const edge = (axis: 0 | 1 | 2): number => Math.max(...along(axis)) - lower(axis);
  const [origin, size]: [Vec3, Vec3] = [[lower(0), lower(1), lower(2)], [edge(0), edge(1), edge(2)]];
  const shares = points.flatMap((point) =>
    ([0, 1, 2] as const).map((axis) => Math.round((65535 * (point[axis] - origin[axis])) / Math.max(1e-9, size[axis]))),
  );
  const bytesOf = (array: Uint16Array | Uint32Array | Int8Array): Uint8Array =>
    new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
  return {
    index: [...index],
    origin,
    size,
    vertices: bytesOf(Uint16Array.from(shares)),
    normals: bytesOf(Int8Array.from(normals.flatMap((normal) => [...normal.map((x) => Math.round(127 * x)), 0]))),
    triangles: bytesOf(points.length > 65536 ? Uint32Array.from(triangles) : Uint16Array.from(triangles)),
  };
}
