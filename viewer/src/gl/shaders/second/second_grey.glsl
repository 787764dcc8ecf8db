// The second scan by window and level, in its colour over the grey of the first: in slices, and where rays
// have one value each.

#ifdef SECOND
// number of one of `tints` (core/second/second_scan.ts)
uniform int secondTint;
uniform float secondOpacity;

vec3 tinted(float share) {
  vec3 warm = clamp(share * vec3(1.6, 1.8, 2.6) - vec3(0.0, 0.5, 1.6), 0.0, 1.0);
  return secondTint == 0 ? warm : secondTint == 1 ? warm.bgr : vec3(share);
}

// Both on the screen (sRGB); `share` of the second's window, 0..1.
vec3 blended(vec3 first, float share) {
  // what is black in a colour leaves the first as it is
  return mix(first, tinted(share), secondOpacity * (secondTint == 2 ? 1.0 : min(1.0, 3.0 * share)));
}
#endif
