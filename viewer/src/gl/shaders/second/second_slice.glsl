// The second scan in a slice, together with the first.

#ifdef SECOND
// share of the window at a biased value: x per value, y at 0
uniform vec2 secondGrey;
// number of one of `fusions` (core/second/second_scan.ts)
uniform int secondFusion;

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
  bool second = secondFusion == 1 ? isOdd(vec3(place / secondSquare, 0.0)) : secondTurn > 0.5;
  return second ? tinted(share) : first;
}
#endif
