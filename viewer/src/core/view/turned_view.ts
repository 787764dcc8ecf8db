/**
 * How far a picture of one view is turned by its depth to another: what it never saw cannot be shown.
 */
import type { Camera } from "../geometry/camera";
import { addScaled, cross, dot, length, normalize, rotateAbout, subtract, type Vec3 } from "../geometry/vector";

/** Beyond, more is uncovered than what lies beside it can stand in for [rad]. */
export const mostTurned = (10 * Math.PI) / 180;
/** So many times as large or small may things become: beyond, a picture's own pixels are what is seen. */
const mostZoomed = 2;
/** No turn [rad]: rounding of the axes alone. */
const noTurn = 1e-6;

/**
 * The view nearest to the present one to which a picture of another can be turned; null where there is none.
 *
 * @param hasDepth the picture tells how deep what is seen lies; without that it can only be moved and zoomed.
 */
export function turnedView(drawn: Camera, now: Camera, hasDepth: boolean): Camera | null {
  const zoomed = now.distance / drawn.distance;
  const isLike = (drawn.parallel === null) === (now.parallel === null) && drawn.field === now.field;
  if (!isLike || zoomed > mostZoomed || zoomed < 1 / mostZoomed) {
    return null;
  }
  const { angle, axis } = turnBetween(drawn, now);
  if (angle <= (hasDepth ? mostTurned : noTurn)) {
    return now;
  }
  return hasDepth ? between(drawn, now, { angle, axis }, mostTurned / angle) : null;
}

/** From one view to another: angle [rad], and axis of length 1. */
interface Turn {
  readonly angle: number;
  readonly axis: Vec3;
}

function turnBetween(one: Camera, other: Camera): Turn {
  // each axis of the view adds the part of the turn's axis that is square to it, times the sine of the angle
  const pairs = [[one.right, other.right], [one.up, other.up], [one.back, other.back]] as const;
  const sine = pairs.reduce<Vec3>((sum, [before, after]) => addScaled(sum, cross(before, after), 0.5), [0, 0, 0]);
  const cosine = (pairs.reduce((sum, [before, after]) => sum + dot(before, after), 0) - 1) / 2;
  const angle = Math.atan2(length(sine), cosine);
  return { angle, axis: length(sine) > 0 ? normalize(sine) : one.up };
}

/** The view at a share of the way from one to another. */
function between(one: Camera, other: Camera, { angle, axis }: Turn, share: number): Camera {
  const turned = (direction: Vec3): Vec3 => normalize(rotateAbout(direction, axis, share * angle));
  const back = turned(one.back);
  const right = turned(one.right);
  return {
    ...other,
    target: addScaled(one.target, subtract(other.target, one.target), share),
    distance: one.distance + (other.distance - one.distance) * share,
    right,
    up: cross(back, right),
    back,
  };
}
