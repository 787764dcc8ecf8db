/**
 * A freehand line over the picture, to cut a segment along. Places in CSS pixels of the picture.
 */
import { rayThrough, type Camera, type Viewport } from "../geometry/camera";
import { addScaled, type Vec3 } from "../geometry/vector";

export type Place = readonly [number, number];

/** Ends nearer than this make a closed line, where it is longer than so many times as much [px]. */
const closingGap = 16;
const closingLength = 5;
/** A shorter line is a click [px]. */
const shortest = 8;
/** Points that deviate by less are left out [px]. */
const tolerance = 1;
/** Most points that the engine takes. */
const mostPoints = 1000;

/** A line as it is sent to the engine. */
export interface FreehandLine {
  readonly places: readonly Place[];
  readonly closed: boolean;
}

/** What a person has painted, without what is no line; null where it was a click. */
export function freehandLine(painted: readonly Place[]): FreehandLine | null {
  const length = lengthOf(painted);
  const [first, last] = [painted[0], painted.at(-1)];
  if (first === undefined || last === undefined || length < shortest) {
    return null;
  }
  const closed = apart(first, last) < closingGap && length > closingLength * closingGap;
  let places = simplified(painted, tolerance);
  for (let coarser = 2 * tolerance; places.length > mostPoints; coarser *= 2) {
    places = simplified(painted, coarser);
  }
  return places.length < (closed ? 3 : 2) ? null : { places, closed };
}

/** Points of the scene under a line, in the plane of the camera's target [mm]. */
export function underLine(places: readonly Place[], camera: Camera, viewport: Viewport): readonly Vec3[] {
  return places.map(([x, y]) => {
    const { origin, direction } = rayThrough(camera, x, y, viewport);
    return addScaled(origin, direction, camera.parallel ?? camera.distance);
  });
}

/**
 * The line without points that deviate less than a tolerance from it.
 *
 * Source: Douglas and Peucker, "Algorithms for the reduction of the number of points required to
 * represent a digitized line or its caricature" (1973).
 */
export function simplified(places: readonly Place[], allowed: number): readonly Place[] {
  const kept = new Set([0, places.length - 1]);
  const open: (readonly [number, number])[] = [[0, places.length - 1]];
  for (let piece = open.pop(); piece !== undefined; piece = open.pop()) {
    const [from, to] = piece;
    let [farthest, most] = [-1, allowed];
    for (let i = from + 1; i < to; ++i) {
      const away = fromPiece(places[i], places[from], places[to]);
      if (away > most) {
        [farthest, most] = [i, away];
      }
    }
    if (farthest > 0) {
      kept.add(farthest);
      open.push([from, farthest], [farthest, to]);
    }
  }
  return places.filter((_, i) => kept.has(i));
}

function lengthOf(places: readonly Place[]): number {
  return places.reduce((sum, place, i) => sum + (i === 0 ? 0 : apart(place, places[i - 1] ?? place)), 0);
}

function apart(a: Place, b: Place): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

/** How far a place is from the straight piece between two others. */
function fromPiece(place?: Place, from?: Place, to?: Place): number {
  if (place === undefined || from === undefined || to === undefined) {
    return 0;
  }
  const [x, y] = [to[0] - from[0], to[1] - from[1]];
  const squared = x * x + y * y;
  const along = squared === 0 ? 0 : ((place[0] - from[0]) * x + (place[1] - from[1]) * y) / squared;
  const share = Math.min(1, Math.max(0, along));
  return apart(place, [from[0] + share * x, from[1] + share * y]);
}
