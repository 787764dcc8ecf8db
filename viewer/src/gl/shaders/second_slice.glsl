// The second scan in a slice, together with the first.

#ifdef SECOND
// share of the window at a biased value: x per value, y at 0
uniform vec2 secondGrey;
// numbers of `fusions` and `tints` (core/second_scan.ts)
uniform int secondFusion;
uniform int secondTint;
uniform float secondOpacity;
// edge of a square [mm], and 1 while the second one of two that flicker is seen
uniform float secondSquare;
uniform float secondTurn;

vec3 tinted(float share) {
  vec3 warm = clamp(share * vec3(1.6, 1.8, 2.6) - vec3(0.0, 0.5, 1.6), 0.0, 1.0);
  return secondTint == 0 ? warm : secondTint == 1 ? warm.bgr : vec3(share);
}

// `place`: in the slice [mm].
vec3 fused(vec3 first, vec3 grid, vec2 place) {
  vec3 there = placeOnSecond(grid);
  if (!isOnSecond(there)) {
    return first;
  }
  float share = clamp(secondBiased(there) * secondGrey.x + secondGrey.y, 0.0, 1.0);
  if (secondFusion == 0) {
    // what is black in a colour leaves the first as it is
    return mix(first, tinted(share), secondOpacity * (secondTint == 2 ? 1.0 : min(1.0, 3.0 * share)));
  }
  vec2 square = floor(place / secondSquare);
  bool second = secondFusion == 1 ? mod(square.x + square.y, 2.0) > 0.5 : secondTurn > 0.5;
  return second ? tinted(share) : first;
}
#endif
