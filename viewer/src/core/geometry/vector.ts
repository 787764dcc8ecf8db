/**
 * Points and vectors of three numbers (x, y, z). Unless a name says otherwise they
 * stand in the scene frame, LPS [mm].
 */

export type Vec3 = readonly [number, number, number];

/** Whether something is three finite numbers. */
export function isPoint(given: unknown): given is Vec3 {
  return Array.isArray(given) && given.length === 3 && given.every((number) => Number.isFinite(number));
}

export function add(a: Vec3, b: Vec3): Vec3 {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

export function subtract(a: Vec3, b: Vec3): Vec3 {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

export function scale(a: Vec3, factor: number): Vec3 {
  return [a[0] * factor, a[1] * factor, a[2] * factor];
}

export function multiply(a: Vec3, b: Vec3): Vec3 {
  return [a[0] * b[0], a[1] * b[1], a[2] * b[2]];
}

/** a + factor · b */
export function addScaled(a: Vec3, b: Vec3, factor: number): Vec3 {
  return [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
}

export function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a: Vec3, b: Vec3): Vec3 {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function length(a: Vec3): number {
  return Math.hypot(a[0], a[1], a[2]);
}

export function distance(a: Vec3, b: Vec3): number {
  return length(subtract(a, b));
}

/** Unit vector along `a`; the zero vector stays zero. */
export function normalize(a: Vec3): Vec3 {
  const size = length(a);
  return size > 0 ? scale(a, 1 / size) : a;
}

/** Turns `a` about a unit `axis` by `angle` [rad], right-handed (Rodrigues). */
export function rotateAbout(a: Vec3, axis: Vec3, angle: number): Vec3 {
  const along = scale(axis, dot(axis, a) * (1 - Math.cos(angle)));
  const across = scale(cross(axis, a), Math.sin(angle));
  return add(add(scale(a, Math.cos(angle)), across), along);
}

/** `a`, drawn back toward `centre` where it is farther than `radius` from it. */
export function clampToBall(a: Vec3, centre: Vec3, radius: number): Vec3 {
  const offset = subtract(a, centre);
  const size = length(offset);
  return size > radius ? addScaled(centre, offset, radius / size) : a;
}
