// The scan as a continuous field, with its tissue where it stands (displacements.glsl). Values are biased stored
// values, 0..65535 (core/scan/stored_values.ts); positions are grid coordinates of the whole scan. The same on the CPU:
// core/scan/field.ts.

uniform sampler3D fieldTexture;
// voxels of the whole scan
uniform vec3 dimensions;
// texture = grid * scale + offset; holds the subsampling
uniform vec3 textureScale;
uniform vec3 textureOffset;
// one sample along each axis [grid]
uniform vec3 sampleStep;
// physical value = slope * biased + constant; only the slope matters to gradients
uniform float slope;

// The value that a texel tells of, or what lies between some.
float storedIn(vec4 texel) {
#if defined(FIELD_RG8) || defined(FIELD_TEXELS)
  // red holds the low byte, green the high one: linear in both, so that they can be filtered before they are joined
  return dot(texel.rg, vec2(255.0, 65280.0));
#elif defined(FIELD_R16)
  return texel.r * 65535.0;
#else
  return texel.r;
#endif
}

#ifdef FIELD_TEXELS
// The eight texels around a place by their shares: where the GPU does it too roughly (gl/march/field_filter.ts).
vec4 filtered(sampler3D values, vec3 place) {
  ivec3 last = textureSize(values, 0) - 1;
  vec3 at = clamp(place * vec3(last + 1) - 0.5, vec3(0.0), vec3(last));
  ivec3 a = ivec3(at);
  ivec3 b = min(a + 1, last);
  vec3 f = at - vec3(a);
#define TEXEL(x, y, z) texelFetch(values, ivec3(x, y, z), 0)
  vec4 front = mix(
    mix(TEXEL(a.x, a.y, a.z), TEXEL(b.x, a.y, a.z), f.x), mix(TEXEL(a.x, b.y, a.z), TEXEL(b.x, b.y, a.z), f.x), f.y);
  vec4 back = mix(
    mix(TEXEL(a.x, a.y, b.z), TEXEL(b.x, a.y, b.z), f.x), mix(TEXEL(a.x, b.y, b.z), TEXEL(b.x, b.y, b.z), f.x), f.y);
  return mix(front, back, f.z);
}
#else
#define filtered texture
#endif

float biasedAt(vec3 grid) {
  return storedIn(filtered(fieldTexture, atRest(grid) * textureScale + textureOffset));
}

// The value of one texel.
float biasedOf(ivec3 texel) {
  return storedIn(texelFetch(fieldTexture, texel, 0));
}

// Gradient of the physical value [per mm] along the grid's axes, by central differences.
vec3 gradientAt(vec3 grid) {
  vec3 dx = vec3(sampleStep.x, 0.0, 0.0);
  vec3 dy = vec3(0.0, sampleStep.y, 0.0);
  vec3 dz = vec3(0.0, 0.0, sampleStep.z);
  vec3 difference = vec3(
    biasedAt(grid + dx) - biasedAt(grid - dx),
    biasedAt(grid + dy) - biasedAt(grid - dy),
    biasedAt(grid + dz) - biasedAt(grid - dz));
  return slope * difference / (2.0 * sampleStep * spacing);
}
