/**
 * What of the picture is cut away: all outside of a box along the scan's axes, and all before free
 * planes. Touch knows nothing of it.
 *
 * Planes stand in the scene [mm]. What is kept lies behind all of them and is convex: a ray goes
 * through it in one piece.
 */
import { transformPoint } from "../geometry/affine";
import { directions, type Letter } from "../geometry/anatomy";
import type { Camera, Ray } from "../geometry/camera";
import type { ScanFrame } from "../scan/scan_volume";
import { add, addScaled, dot, isPoint, length, multiply, scale, subtract, type Vec3 } from "../geometry/vector";

export interface Plane {
  /** Unit vector toward what is cut away. */
  readonly normal: Vec3;
  /** `dot(normal, point)` of its points [mm]. */
  readonly offset: number;
}

export interface FreePlane extends Plane {
  readonly on: boolean;
}

/** How much is cut away from the scan's low and high faces, along its own axes [mm]. */
export interface ClipBox {
  readonly on: boolean;
  readonly low: Vec3;
  readonly high: Vec3;
}

export interface Clip {
  readonly box: ClipBox;
  readonly planes: readonly FreePlane[];
}

/** A face of the box: that of the low or the high end of an axis of the grid. */
export interface Face {
  readonly letter: Letter;
  readonly axis: 0 | 1 | 2;
  readonly side: "low" | "high";
}

export const mostFreePlanes = 6;
/** In sync with `gl/shaders/clip.glsl`. */
export const mostPlanes = 6 + mostFreePlanes;

export const nothingClipped: Clip = { box: { on: false, low: [0, 0, 0], high: [0, 0, 0] }, planes: [] };

/** Of the whole scan along its axes [mm]. */
export function sizeOf({ dimensions, spacing }: ScanFrame): Vec3 {
  return multiply(dimensions, spacing);
}

/** The six faces by the directions of the body that they look toward: right, left, anterior, … */
export function facesOf({ axes }: ScanFrame): Face[] {
  const body = [directions.L, directions.P, directions.S] as const;
  const orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] as const;
  // each axis of the body has one of the grid, so that an oblique scan has no letter twice
  const fit = (order: readonly (0 | 1 | 2)[]): number =>
    order.reduce<number>((sum, axis, place) => sum + Math.abs(dot(axes[axis], body[place] ?? body[0])), 0);
  const best = orders.reduce((one, other) => (fit(other) > fit(one) ? other : one));
  const pairs = [["R", "L"], ["A", "P"], ["I", "S"]] as const;
  return pairs.flatMap(([away, toward], place) => {
    const axis = best[place] ?? 0;
    const along = dot(axes[axis], directions[toward]) >= 0;
    return [
      { letter: away, axis, side: along ? "low" : "high" },
      { letter: toward, axis, side: along ? "high" : "low" },
    ] as const;
  });
}

/** The box after a face was put elsewhere; a voxel of it is left. */
export function withCut(box: ClipBox, frame: ScanFrame, { axis, side }: Face, millimetres: number): ClipBox {
  const other = box[side === "low" ? "high" : "low"][axis];
  const most = sizeOf(frame)[axis] - frame.spacing[axis] - other;
  const cuts: [number, number, number] = [...box[side]];
  cuts[axis] = Math.max(0, Math.min(most, millimetres));
  return { ...box, [side]: cuts };
}

/** Corners of what the box keeps, in the scene; the bits of a place say low or high. */
export function keptCorners(box: ClipBox, frame: ScanFrame): Vec3[] {
  const high = subtract(sizeOf(frame), box.high);
  return [0, 1, 2, 3, 4, 5, 6, 7].map((place) => {
    const along = (axis: 0 | 1 | 2): number => ((place >> axis) & 1 ? high : box.low)[axis] / frame.spacing[axis];
    return transformPoint(frame.sceneFromGrid, [along(0), along(1), along(2)]);
  });
}

/** Unit vector out of the box. */
export function outward({ axes }: ScanFrame, { axis, side }: Face): Vec3 {
  return scale(axes[axis], side === "low" ? -1 : 1);
}

/** Middle of a face of what the box keeps, in the scene. */
export function faceMiddle(box: ClipBox, frame: ScanFrame, { axis, side }: Face): Vec3 {
  const corners = keptCorners(box, frame).filter((_, place) => ((place >> axis) & 1) === (side === "low" ? 0 : 1));
  return scale(corners.reduce(add), 1 / corners.length);
}

/** All planes that cut something away. */
export function planesOf({ box, planes }: Clip, frame: ScanFrame): Plane[] {
  const faces = box.on ? facesOf(frame).filter(({ axis, side }) => box[side][axis] > 0) : [];
  return [
    ...faces.map((face) => {
      const normal = outward(frame, face);
      return { normal, offset: dot(normal, faceMiddle(box, frame, face)) };
    }),
    ...planes.filter(({ on }) => on).slice(0, mostFreePlanes),
  ];
}

/** A plane through the middle of the view that cuts away what stands before it. */
export function planeAcross({ back, target }: Camera): FreePlane {
  return { normal: back, offset: dot(back, target), on: true };
}

/** Cuts away the other side. */
export function flipped(plane: FreePlane): FreePlane {
  return { ...plane, normal: scale(plane.normal, -1), offset: -plane.offset };
}

/** The point of a plane that is nearest to another one. */
export function onPlane({ normal, offset }: Plane, near: Vec3): Vec3 {
  return addScaled(near, normal, offset - dot(normal, near));
}

/** From where to where along a ray nothing is cut away [of its direction]; the first is larger where all is. */
export function keptSpan(planes: readonly Plane[], { origin, direction }: Ray): readonly [number, number] {
  let [enter, leave] = [0, Infinity];
  for (const { normal, offset } of planes) {
    const before = dot(normal, origin) - offset;
    const rise = dot(normal, direction);
    if (rise > 0) {
      leave = Math.min(leave, -before / rise);
    } else if (rise < 0) {
      enter = Math.max(enter, -before / rise);
    } else if (before > 0) {
      leave = -Infinity;
    }
  }
  return [enter, leave];
}

/** What was kept of a clip, as far as it is one of this scan. */
export function saneClip(given: unknown, frame: ScanFrame): Clip {
  const { box, planes } = (given ?? {}) as Partial<Record<keyof Clip, unknown>>;
  return {
    box: saneBox(box, frame),
    planes: Array.isArray(planes) ? planes.filter(isFreePlane).slice(0, mostFreePlanes) : [],
  };
}

function saneBox(given: unknown, frame: ScanFrame): ClipBox {
  const { on, low, high } = (given ?? {}) as Partial<Record<keyof ClipBox, unknown>>;
  if (!isPoint(low) || !isPoint(high)) {
    return nothingClipped.box;
  }
  const cuts = { low, high } as const;
  return facesOf(frame).reduce<ClipBox>(
    (box, face) => withCut(box, frame, face, cuts[face.side][face.axis]),
    { ...nothingClipped.box, on: on === true },
  );
}

function isFreePlane(given: unknown): given is FreePlane {
  const { normal, offset, on } = (given ?? {}) as Partial<Record<keyof FreePlane, unknown>>;
  return isPoint(normal) && Math.abs(length(normal) - 1) < 1e-3 && Number.isFinite(offset) && typeof on === "boolean";
}
