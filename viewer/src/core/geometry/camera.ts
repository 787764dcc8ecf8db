/**
 * The camera: a point it looks at, how far it is, and its axes, in the scene frame [mm].
 *
 * Orbiting turns about the body's long axis (superior) and the picture's horizontal axis,
 * so the head stays up. All functions are pure and return a new camera.
 */
import { directions, type Letter } from "./anatomy";
import {
  add,
  addScaled,
  cross,
  distance,
  dot,
  isPoint,
  length,
  normalize,
  rotateAbout,
  scale,
  subtract,
  type Vec3,
} from "./vector";

export interface Camera {
  /** Point in the middle of the picture. */
  readonly target: Vec3;
  /** From the eye to the target [mm]. */
  readonly distance: number;
  /** Unit axes of the view: to the right, up, and back toward the person. */
  readonly right: Vec3;
  readonly up: Vec3;
  readonly back: Vec3;
  /** Vertical angle of view [rad]. */
  readonly field: number;
  /**
   * Orthographic: how far before the target rays begin, side by side [mm]; the picture is as high as a
   * perspective one is at the target. Null: in perspective.
   */
  readonly parallel: number | null;
  /**
   * One of two eyes: it stands so far to the right [share of the distance to the target] and looks straight
   * ahead through the same window at the target (off-axis). 0 where it is left out.
   */
  readonly aside?: number;
}

/** A camera that was kept; null where something else is given. */
export function saneCamera(given: unknown): Camera | null {
  if (typeof given !== "object" || given === null) {
    return null;
  }
  const {
    target,
    distance: far,
    right,
    up,
    back,
    field,
    parallel = null,
  } = given as Partial<Record<keyof Camera, unknown>>;
  const axes = [right, up, back];
  if (!isPoint(target) || !isPoint(right) || !isPoint(up) || !isPoint(back)) {
    return null;
  }
  const straight = axes.filter(isPoint).every((axis) => Math.abs(length(axis) - 1) < 1e-3);
  const square = [dot(right, up), dot(up, back), dot(back, right)].every((cosine) => Math.abs(cosine) < 1e-3);
  const sized =
    typeof far === "number" && far > 0 && far < 1e6 && typeof field === "number" && field > 0 && field < Math.PI;
  if (parallel !== null && !(typeof parallel === "number" && parallel > 0 && parallel < 1e6)) {
    return null;
  }
  return straight && square && sized ? { target, distance: far, right, up, back, field, parallel } : null;
}

/** The space that is shown: points around it, its middle and the ball around it [mm]. */
export interface Extent {
  readonly outline: readonly Vec3[];
  readonly centre: Vec3;
  readonly radius: number;
}

export interface Ray {
  readonly origin: Vec3;
  readonly direction: Vec3;
}

/** Size of the picture [CSS pixels]. */
export interface Viewport {
  readonly width: number;
  readonly height: number;
}

// a long lens, as medical pictures are drawn: little perspective distortion
const fieldOfView = (24 * Math.PI) / 180;

/** Share of the picture's width or height that the content fills after framing. */
const filled = 0.9;

export function extentOf(outline: readonly Vec3[]): Extent {
  const along = (axis: 0 | 1 | 2, pick: (...values: number[]) => number): number =>
    pick(...outline.map((point) => point[axis]));
  const middle = (axis: 0 | 1 | 2): number => (along(axis, Math.min) + along(axis, Math.max)) / 2;
  const centre: Vec3 = [middle(0), middle(1), middle(2)];
  return { outline, centre, radius: Math.max(...outline.map((point) => distance(point, centre))) };
}

/** Looks from a direction of the body, e.g. "A": the viewer stands before the patient. */
export function lookFrom(letter: Letter, extent: Extent, viewport: Viewport): Camera {
  const alongBody = letter === "S" || letter === "I";
  return lookAlong(scale(directions[letter], -1), alongBody ? directions.A : directions.S, extent, viewport);
}

/** The first view of a scan: from before, a little from the patient's left and from above. */
export function firstView(extent: Extent, viewport: Viewport): Camera {
  const front = lookFrom("A", extent, viewport);
  return frame(orbit(front, -0.42, 0.16), extent, viewport);
}

/** Looks along a direction with `up` upward in the picture, the whole content in view. */
export function lookAlong(direction: Vec3, up: Vec3, extent: Extent, viewport: Viewport): Camera {
  const back = normalize(scale(direction, -1));
  const right = normalize(cross(up, back));
  return frame(
    { target: extent.centre, distance: 1, right, up: cross(back, right), back, field: fieldOfView, parallel: null },
    extent,
    viewport,
  );
}

/** Moves the camera, without turning it, so that it just shows the whole content in its middle. */
export function frame(camera: Camera, extent: Extent, viewport: Viewport): Camera {
  const along = (axis: Vec3): readonly [number, number] => {
    const places = extent.outline.map((point) => dot(axis, point));
    return [Math.min(...places), Math.max(...places)];
  };
  const middle = (axis: Vec3): number => (along(axis)[0] + along(axis)[1]) / 2;
  const target = [camera.right, camera.up, camera.back].reduce<Vec3>(
    (sum, axis) => addScaled(sum, axis, middle(axis)),
    [0, 0, 0],
  );

  const vertical = Math.tan(camera.field / 2) * filled;
  const horizontal = vertical * (viewport.width / Math.max(1, viewport.height));
  const needed = extent.outline.map((point) => {
    const offset = subtract(point, target);
    const sideways = Math.max(
      Math.abs(dot(offset, camera.right)) / horizontal,
      Math.abs(dot(offset, camera.up)) / vertical,
    );
    return camera.parallel === null ? sideways + dot(offset, camera.back) : sideways;
  });
  return { ...camera, target, distance: Math.max(...needed) };
}

/** The camera that shows as much in a picture of another shape: its shorter side spans the same. */
export function reshaped(camera: Camera, before: Viewport, now: Viewport): Camera {
  const share = ({ width, height }: Viewport): number => Math.min(1, width / Math.max(1, height));
  return { ...camera, distance: (camera.distance * share(before)) / Math.max(share(now), 1e-3) };
}

/** The same view in an orthographic projection, or in perspective. */
export function inProjection(camera: Camera, orthographic: boolean, extent: Extent): Camera {
  // far enough before all content, also after some panning
  return { ...camera, parallel: orthographic ? 4 * extent.radius + distance(camera.target, extent.centre) : null };
}

/** Turns the picture as if its content were dragged by these angles [rad]. */
export function orbit(camera: Camera, horizontal: number, vertical: number): Camera {
  // dragging right turns the front of the body to the right, also when it hangs head down
  const upright = dot(camera.up, directions.S) >= 0 ? 1 : -1;
  const turned = rotate(camera, directions.S, -horizontal * upright);
  return rotate(turned, turned.right, -vertical);
}

function rotate(camera: Camera, axis: Vec3, angle: number): Camera {
  const back = normalize(rotateAbout(camera.back, axis, angle));
  const right = normalize(rotateAbout(camera.right, axis, angle));
  return { ...camera, back, right, up: cross(back, right) };
}

/** Comes nearer (`factor` < 1) or goes away, within sensible distances of the content. */
export function zoom(camera: Camera, factor: number, extent: Extent): Camera {
  const nearest = 0.05 * extent.radius;
  const farthest = 20 * extent.radius;
  return { ...camera, distance: Math.min(farthest, Math.max(nearest, camera.distance * factor)) };
}

/** Moves the picture's content by pixels. */
export function pan(camera: Camera, x: number, y: number, viewport: Viewport): Camera {
  return { ...camera, target: subtract(camera.target, alongView(camera, x, y, camera.target, viewport)) };
}

/** From the target toward the eye, per mm of depth. */
export function sightOf(camera: Camera): Vec3 {
  return addScaled(camera.back, camera.right, camera.aside ?? 0);
}

/** Where all rays begin; in an orthographic view the one in the picture's middle. */
export function eyeOf(camera: Camera): Vec3 {
  return addScaled(camera.target, sightOf(camera), camera.parallel ?? camera.distance);
}

/** An eye from which everything is seen as in the picture: of an orthographic one nearly, from far away. */
export function vantage(camera: Camera): Vec3 {
  return camera.parallel === null ? eyeOf(camera) : addScaled(camera.target, sightOf(camera), 1e4 * camera.parallel);
}

/** Distance of a point from the eye along the direction of view [mm]. */
export function depthOf(camera: Camera, point: Vec3): number {
  return dot(subtract(eyeOf(camera), point), camera.back);
}

/** Size of a CSS pixel at a point [mm]. */
export function pixelSizeAt(camera: Camera, point: Vec3, viewport: Viewport): number {
  const depth = camera.parallel === null ? Math.max(1e-3, depthOf(camera, point)) : camera.distance;
  return (2 * depth * Math.tan(camera.field / 2)) / Math.max(1, viewport.height);
}

/** Vector in the view plane through `point` that covers x pixels rightward, y downward. */
export function alongView(camera: Camera, x: number, y: number, point: Vec3, viewport: Viewport): Vec3 {
  const size = pixelSizeAt(camera, point, viewport);
  return add(scale(camera.right, x * size), scale(camera.up, -y * size));
}

/** Ray through a place of the picture; x and y in CSS pixels from its upper left corner. */
export function rayThrough(camera: Camera, x: number, y: number, viewport: Viewport): Ray {
  const half = Math.tan(camera.field / 2);
  const across = ((2 * x) / viewport.width - 1) * half * (viewport.width / viewport.height);
  const upward = (1 - (2 * y) / viewport.height) * half;
  const sideways = add(scale(camera.right, across), scale(camera.up, upward));
  return camera.parallel === null
    ? { origin: eyeOf(camera), direction: normalize(subtract(sideways, sightOf(camera))) }
    : { origin: addScaled(eyeOf(camera), sideways, camera.distance), direction: scale(normalize(sightOf(camera)), -1) };
}

/** Where a point appears [CSS pixels]; null behind the eye. */
export function project(camera: Camera, point: Vec3, viewport: Viewport): readonly [number, number] | null {
  if (camera.parallel === null && depthOf(camera, point) <= 0) {
    return null;
  }
  const offset = subtract(point, camera.target);
  const size = pixelSizeAt(camera, point, viewport);
  const right = dot(offset, camera.right) - (camera.aside ?? 0) * dot(offset, camera.back);
  return [viewport.width / 2 + right / size, viewport.height / 2 - dot(offset, camera.up) / size];
}

/** Near and far planes that hold the content and what moves a little outside it [mm]. */
export function nearAndFar(camera: Camera, extent: Extent): { near: number; far: number } {
  const depth = depthOf(camera, extent.centre);
  const reach = 2 * extent.radius;
  const far = Math.max(depth + reach, 2);
  return { near: Math.max(depth - reach, far / 2000), far };
}

export function sameView(a: Camera, b: Camera): boolean {
  const same = (u: Vec3, v: Vec3): boolean => u[0] === v[0] && u[1] === v[1] && u[2] === v[2];
  return (
    a.distance === b.distance &&
    a.parallel === b.parallel &&
    a.aside === b.aside &&
    same(a.target, b.target) &&
    same(a.right, b.right) &&
    same(a.up, b.up)
  );
}
