/**
 * What a ray shows first of two scans in one view: each is met by its own appearance, and the nearer one is seen. In
 * cells or by turns only one of both is at a place.
 */
import { transformPoint, transformVector, type Affine } from "../geometry/affine";
import type { Ray } from "../geometry/camera";
import { keptSpan } from "../view/clip";
import type { Appearance } from "../appearance/appearance";
import { isGrey } from "../appearance/optics";
import { nothingElse, pickSurface, type AlsoDrawn, type Picked } from "./pick_surface";
import type { ScanVolume } from "../scan/scan_volume";
import type { SecondAppearance } from "../second/second_scan";
import { addScaled, dot, length, multiply, subtract, type Vec3 } from "../geometry/vector";

export interface DrawnSecond {
  readonly volume: ScanVolume;
  /** Points of the first scan to the second's, patient of each [mm]. */
  readonly place: Affine;
  readonly appearance: SecondAppearance;
}

export interface PickedOfTwo extends Picked {
  readonly scan: "first" | "second";
}

/** First visible point along a ray of the first scan's scene; its value is that of the scan that it belongs to. */
export function pickScans(
  volume: ScanVolume,
  appearance: Appearance,
  ray: Ray,
  also: AlsoDrawn,
  second: DrawnSecond | null,
): PickedOfTwo | null {
  if (second?.appearance.inView !== true) {
    return of("first", pickSurface(volume, appearance, ray, also));
  }
  const hasTurn = (t: number): boolean =>
    isSecondsTurn(volume, second, appearance, addScaled(ray.origin, ray.direction, t));
  const first = of("first", pickSurface(volume, appearance, ray, { ...also, isLeftOut: hasTurn }));
  const other = pickSecond(second, appearance, ray, also, hasTurn);
  const along = ({ point }: Picked): number => dot(subtract(point, ray.origin), ray.direction);
  if (first === null || other === null) {
    return first ?? other;
  }
  // of one value each the second's lies in colour over the first's, which is found
  return !isGrey(appearance.optics.blend) && along(other) < along(first) ? other : first;
}

function of(scan: PickedOfTwo["scan"], picked: Picked | null): PickedOfTwo | null {
  return picked && { ...picked, scan };
}

function pickSecond(
  { volume, place, appearance }: DrawnSecond,
  shown: Appearance,
  ray: Ray,
  { clip }: AlsoDrawn,
  hasTurn: (t: number) => boolean,
): PickedOfTwo | null {
  const own = { origin: transformPoint(place, ray.origin), direction: transformVector(place, ray.direction) };
  const kept = keptSpan(clip, ray);
  const takesTurns = appearance.viewFusion !== "blend" && !isGrey(shown.optics.blend);
  const isLeftOut = (t: number): boolean => t < kept[0] || t > kept[1] || (takesTurns && !hasTurn(t));
  const picked = pickSurface(volume, lookOfSecond(appearance, shown), own, { ...nothingElse, isLeftOut });
  if (picked === null) {
    return null;
  }
  const t = length(subtract(picked.point, own.origin)) / length(own.direction);
  return { ...picked, point: addScaled(ray.origin, ray.direction, t), scan: "second" };
}

/** The appearance of the second scan beside the first. */
function lookOfSecond(
  { transferFunction, density, edgeGradient, isoValue, tissueFrom, windows }: SecondAppearance,
  shown: Appearance,
): Appearance {
  const { blend } = shown.optics;
  const window = isGrey(blend) ? windows[blend] : windows.mip;
  const points = transferFunction.points.map((point) => ({ ...point, extinction: density * point.extinction }));
  return {
    ...shown,
    transferFunction: { ...transferFunction, points },
    edgeGradient,
    ranges: [],
    optics: { ...shown.optics, isoValue, tissueFrom, window },
  };
}

/**
 * Whether a point of the scene shows the second scan and nothing of the first, as `shaders/second/second_ray.glsl`
 * says.
 */
function isSecondsTurn(
  { frame }: ScanVolume,
  { volume, place, appearance }: DrawnSecond,
  shown: Appearance,
  point: Vec3,
): boolean {
  if (appearance.viewFusion === "blend" || isGrey(shown.optics.blend)) {
    return false;
  }
  const inSecond = transformPoint(volume.frame.gridFromScene, transformPoint(place, point));
  if (inSecond.some((c, axis) => c < 0 || c > (volume.frame.dimensions[axis] ?? 0))) {
    return false;
  }
  if (appearance.viewFusion === "flicker") {
    return appearance.turn === "second";
  }
  const along = multiply(transformPoint(frame.gridFromScene, point), frame.spacing);
  const cells = along.reduce((sum, millimetres) => sum + Math.floor(millimetres / appearance.square), 0);
  return cells % 2 !== 0;
}
