// The second scan in a slice, together with the first.

#ifdef SECOND
// share of the window at a biased value: x per value, y at 0
uniform vec2 secondGrey;
// number of one of `fusions` (core/second_scan.ts)
uniform int secondFusion;
// edge of a square [mm], and 1 while the second one of two that flicker is seen
uniform float secondSquare;
uniform float secondTurn;

// `place`: in the slice [mm].
vec3 fused(vec3 first, vec3 grid, vec2 place) {
  vec3 there = placeOnSecond(grid);
  if (!isOnSecond(there)) {
    return first;
  }
  float share = clamp(secondBiased(there) * secondGrey.x + secondGrey.y, 0.0, 1.0);
  if (secondFusion == 0) {
    return blended(first, share);
  }
  vec2 square = floor(place / secondSquare);
  bool second = secondFusion == 1 ? mod(square.x + square.y, 2.0) > 0.5 : secondTurn > 0.5;
  return second ? tinted(share) : first;
}
#endif
