/**
 * Directions of the body in LPS: +x to the patient's left, +y to the back, +z to the head.
 */
import { dot, scale, type Vec3 } from "./vector";

export type Letter = "L" | "R" | "P" | "A" | "S" | "I";

export const directions: Readonly<Record<Letter, Vec3>> = {
  L: [1, 0, 0],
  R: [-1, 0, 0],
  P: [0, 1, 0],
  A: [0, -1, 0],
  S: [0, 0, 1],
  I: [0, 0, -1],
};

// @texts
export const names: Readonly<Record<Letter, string>> = {
  L: "left",
  R: "right",
  P: "posterior",
  A: "anterior",
  S: "superior",
  I: "inferior",
};

export const letters: readonly Letter[] = ["A", "P", "L", "R", "S", "I"];

/** What stands for sides where no file tells which they are: the scan's own axes. */
export const axisSides: Readonly<Record<Letter, string>> = { L: "+x", R: "−x", P: "+y", A: "−y", S: "+z", I: "−z" };

/** A side in words; that of the scan's axis where sides are not known. */
export function sideName(letter: Letter, known: boolean): string {
  return known ? names[letter] : axisSides[letter];
}

/** Said beside axes of the scan. */
export const unknownOrientation =
  "The file does not tell which sides of the body these are: x, y and z are the scan's own axes. The panel " +
  "Scan takes its orientation.";

/** Share of a direction below which its letter is left out, about 27 degrees. */
const smallestShare = 0.45;

/**
 * Letters toward which a unit direction points, the strongest first: "LA" is left, some anterior; axes where sides are
 * not known.
 */
export function lettersOf(direction: Vec3, known = true): string {
  return letters
    .map((letter) => ({ letter, share: dot(directions[letter], direction) }))
    .filter(({ share }) => share > smallestShare)
    .sort((a, b) => b.share - a.share)
    .map(({ letter }) => (known ? letter : axisSides[letter]))
    .join(known ? "" : " ");
}

/** Letters at the right, left, top and bottom edge of the picture. */
export function edgeLetters(
  right: Vec3,
  up: Vec3,
  known: boolean,
): Record<"right" | "left" | "top" | "bottom", string> {
  return {
    right: lettersOf(right, known),
    left: lettersOf(scale(right, -1), known),
    top: lettersOf(up, known),
    bottom: lettersOf(scale(up, -1), known),
  };
}
