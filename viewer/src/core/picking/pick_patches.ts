/**
 * Where a ray of the picture crosses the surfaces of segments, wherever these stand by now.
 *
 * A ray is brought into the frame of each surface by the inverse of its pose; patches whose box
 * it misses are passed over. Source of the test of a triangle: Möller and Trumbore, "Fast,
 * minimum storage ray/triangle intersection", Journal of Graphics Tools (1997).
 */
import { invertAffine, transformPoint, transformVector } from "../geometry/affine";
import type { Ray } from "../geometry/camera";
import { throughBox } from "./pick_surface";
import type { Pose } from "../protocol";
import type { Patch } from "../surfaces/surface_patches";
import { addScaled, cross, dot, subtract, type Vec3 } from "../geometry/vector";

/** A surface as it is drawn. */
export interface DrawnSurface {
  readonly id: number;
  /** From where the scan has it to where it stands. */
  readonly pose: Pose;
  readonly opacity: number;
  readonly patches: readonly Patch[];
}

/** A place where a ray goes through a surface. */
export interface Crossing {
  /** Length along the ray [of its direction]. */
  readonly t: number;
  readonly id: number;
  readonly opacity: number;
}

/** Largest number of a vertex along its patch's box. */
const fullShare = 65535;

/** All crossings of a ray with surfaces, near to far. */
export function surfaceCrossings(surfaces: readonly DrawnSurface[], ray: Ray): Crossing[] {
  const crossings = surfaces.flatMap(({ id, pose, opacity, patches }) => {
    const surfaceFromScene = invertAffine(pose);
    const origin = transformPoint(surfaceFromScene, ray.origin);
    const direction = transformVector(surfaceFromScene, ray.direction);
    return patches.flatMap((patch) => patchCrossings(patch, origin, direction).map((t) => ({ t, id, opacity })));
  });
  return crossings.sort((a, b) => a.t - b.t);
}

function patchCrossings({ origin, size, vertices, triangles }: Patch, start: Vec3, direction: Vec3): number[] {
  const inPatch = subtract(start, origin);
  if (!meetsBox(inPatch, direction, size)) {
    return [];
  }
  const vertex = (number: number): Vec3 => {
    const along = (axis: 0 | 1 | 2): number => ((vertices[3 * number + axis] ?? 0) / fullShare) * size[axis];
    return [along(0), along(1), along(2)];
  };
  const found: number[] = [];
  for (let corner = 0; corner + 2 < triangles.length; corner += 3) {
    const [a, b, c] = [0, 1, 2].map((place) => vertex(triangles[corner + place] ?? 0)) as [Vec3, Vec3, Vec3];
    const t = throughTriangle(inPatch, direction, a, b, c);
    if (t !== null) {
      found.push(t);
    }
  }
  return found;
}

/** A flat patch has a flat box, which a ray in its plane may still meet: a little room does no harm. */
function meetsBox(start: Vec3, direction: Vec3, size: Vec3): boolean {
  const room = 1e-3;
  const wide: Vec3 = [size[0] + 2 * room, size[1] + 2 * room, size[2] + 2 * room];
  return throughBox(addScaled(start, [1, 1, 1], room), direction, wide) !== null;
}

/** Where a ray goes through a triangle from either side; null where it passes by. */
export function throughTriangle(start: Vec3, direction: Vec3, a: Vec3, b: Vec3, c: Vec3): number | null {
  const [ab, ac] = [subtract(b, a), subtract(c, a)];
  const across = cross(direction, ac);
  const determinant = dot(ab, across);
  if (determinant === 0) {
    return null;
  }
  const offset = subtract(start, a);
  const u = dot(offset, across) / determinant;
  const around = cross(offset, ab);
  const v = dot(direction, around) / determinant;
  const t = dot(ac, around) / determinant;
  // written so that numbers that are none pass by
  return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 ? t : null;
}
