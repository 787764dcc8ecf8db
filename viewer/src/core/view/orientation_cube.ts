/**
 * The orientation cube as flat polygons: which faces of the body's box the camera sees.
 *
 * Drawn without perspective, so the picture of each face is an affine image of a square and
 * letters can lie on it. Coordinates of the drawing: unit cube edge = 1, y downward.
 */
import { directions, letters, type Letter } from "../geometry/anatomy";
import { cross, dot, scale, type Vec3 } from "../geometry/vector";

export interface CubeFace {
  readonly letter: Letter;
  /** SVG matrix (a b c d e f) from a square -0.5..0.5 with y downward to the drawing. */
  readonly matrix: readonly [number, number, number, number, number, number];
  /** How much the face looks at the viewer, 0..1. */
  readonly facing: number;
}

/** Upward direction of the letter on each face. */
function upOf(letter: Letter): Vec3 {
  return letter === "S" ? directions.P : letter === "I" ? directions.A : directions.S;
}

/** The faces seen by a camera with these axes, the most slanted first. */
export function cubeFaces(right: Vec3, up: Vec3, back: Vec3): CubeFace[] {
  const flat = (v: Vec3): readonly [number, number] => [dot(v, right), -dot(v, up)];
  return letters
    .map((letter): CubeFace => {
      const outward = directions[letter];
      const faceUp = upOf(letter);
      const across = flat(cross(faceUp, outward));
      const down = flat(scale(faceUp, -1));
      const centre = flat(scale(outward, 0.5));
      return {
        letter,
        matrix: [across[0], across[1], down[0], down[1], centre[0], centre[1]],
        facing: dot(outward, back),
      };
    })
    .filter(({ facing }) => facing > 0.02)
    .sort((a, b) => a.facing - b.facing);
}
