// The second scan as tissue: absorption and emission by its own transfer function, in the
// same intervals as the first.

#ifdef SECOND
uniform sampler2D secondTransfer;
// biased value -> place in the row, 0..1
uniform vec2 secondScale;
// factor on its extinction, and gradient of a full boundary [value per mm] over its slope
uniform float secondDensity;
uniform float secondEdge;

// Colour, extinction [1/mm].
vec4 secondTissueAt(float value) {
  float texels = float(textureSize(secondTransfer, 0).x);
  float row = clamp(value * secondScale.x + secondScale.y, 0.0, 1.0);
  vec4 tissue = texture(secondTransfer, vec2((row * (texels - 1.0) + 0.5) / texels, 0.5));
  return vec4(tissue.rgb, tissue.a * secondDensity);
}

// What there is of it: colour as it is lit, extinction [1/mm].
vec4 litSecond(vec3 grid, vec3 toEye) {
  vec3 place = placeOnSecond(grid);
  if (!isOnSecond(place) || !showsSecond(grid)) {
    return vec4(0.0);
  }
  vec4 tissue = secondTissueAt(secondBiased(place));
  if (tissue.a <= 0.0) {
    return vec4(0.0);
  }
#if BLEND == SHADED || BLEND == COMPOSITE
  vec3 gradient = secondGradient(grid);
  float boundary = smoothstep(0.0, secondEdge, length(gradient));
  tissue.a *= mix(edge.y, 1.0, boundary);
#if BLEND == SHADED
  vec3 normal = facing(gradient, toEye, toEye);
  tissue.rgb = litTissue(tissue.rgb, normal, toEye, boundary, lightOnSecond(grid, normal * boundary), vec2(1.0));
#endif
#endif
  return tissue;
}

// Two kinds of tissue in one place: both absorb, and each adds its light as much as it does.
vec4 mixed(vec4 one, vec4 other) {
  float sum = one.a + other.a;
  return vec4((one.a * one.rgb + other.a * other.rgb) / max(sum, 1e-9), sum);
}
#endif
