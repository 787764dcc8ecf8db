// The second scan in the way of a ray: absorption and emission by its own transfer function, in the
// same intervals as the first.

#ifdef SECOND
uniform sampler2D secondTransfer;
// biased value -> place in the row, 0..1
uniform vec2 secondScale;
// factor on its extinction, and gradient of a full boundary [value per mm] over its slope
uniform float secondDensity;
uniform float secondEdge;
uniform sampler3D secondBricks;
// place in its texture -> its bricks
uniform vec3 secondBrickScale;

// Colour, extinction [1/mm].
vec4 secondTissueAt(float value) {
  float texels = float(textureSize(secondTransfer, 0).x);
  float row = clamp(value * secondScale.x + secondScale.y, 0.0, 1.0);
  vec4 tissue = texture(secondTransfer, vec2((row * (texels - 1.0) + 0.5) / texels, 0.5));
  return vec4(tissue.rgb, tissue.a * secondDensity);
}

// Gradient of its biased value along the first scan's axes [per mm], from a tetrahedron of half a voxel.
vec3 secondGradient(vec3 grid) {
  vec3 reach = 0.75 * sampleStep;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    vec3 corner = vec3(i < 2 ? 1.0 : -1.0, (i & 1) == 0 ? 1.0 : -1.0, i == 0 || i == 3 ? 1.0 : -1.0);
    sum += corner * secondBiased(placeOnSecond(grid + corner * reach));
  }
  return sum / (4.0 * reach * spacing);
}

// What there is of it: colour as it is lit, extinction [1/mm].
vec4 litSecond(vec3 grid, vec3 toEye) {
  vec3 place = placeOnSecond(grid);
  if (!isOnSecond(place)) {
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
  tissue.rgb = litTissue(tissue.rgb, normal, toEye, boundary, lightAt(grid, normal * boundary));
#endif
#endif
  return tissue;
}

// Length along a ray in which nothing of it is drawn [mm]; 0 where something is.
float secondEmptyAhead(vec3 grid, vec3 inGrid) {
  vec3 face;
  vec3 place = placeOnSecond(grid);
  vec3 speed = mat3(secondFromGrid) * inGrid;
  vec2 within = throughBox(vec3(0.0), vec3(1.0), place, speed, face);
  if (within.y <= within.x) {
    return farAway;
  }
  if (within.x > 0.0) {
    return within.x;
  }
  vec3 inBricks = (place * secondTextureScale + secondTextureOffset) * secondBrickScale;
  vec3 brick = floor(clamp(inBricks, vec3(0.0), vec3(textureSize(secondBricks, 0)) - 0.5));
  float reach = floor(texelFetch(secondBricks, ivec3(brick), 0).r * 255.0 + 0.5);
  if (reach == 0.0) {
    return 0.0;
  }
  speed *= secondTextureScale * secondBrickScale;
  vec3 ahead = mix(inBricks - brick + (reach - 1.0), brick + reach - inBricks, step(0.0, speed));
  vec3 lengths = ahead / max(abs(speed), 1e-9);
  return max(min(min(lengths.x, lengths.y), lengths.z), 0.0);
}
// Two kinds of tissue in one place: both absorb, and each adds its light as much as it does.
vec4 mixed(vec4 one, vec4 other) {
  float sum = one.a + other.a;
  return vec4((one.a * one.rgb + other.a * other.rgb) / max(sum, 1e-9), sum);
}
#endif
