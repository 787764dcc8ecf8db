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

float biasedAt(vec3 grid) {
  vec3 place = atRest(grid) * textureScale + textureOffset;
#if defined(FIELD_RG8)
  // red holds the low byte, green the high one: linear in both, so filtering stays exact
  return dot(texture(fieldTexture, place).rg, vec2(255.0, 65280.0));
#elif defined(FIELD_R16)
  return texture(fieldTexture, place).r * 65535.0;
#else
  return texture(fieldTexture, place).r;
#endif
}

// The value of one texel.
float biasedOf(ivec3 texel) {
#if defined(FIELD_RG8)
  return dot(texelFetch(fieldTexture, texel, 0).rg, vec2(255.0, 65280.0));
#elif defined(FIELD_R16)
  return texelFetch(fieldTexture, texel, 0).r * 65535.0;
#else
  return texelFetch(fieldTexture, texel, 0).r;
#endif
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
