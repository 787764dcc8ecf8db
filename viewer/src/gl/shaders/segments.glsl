// Which segment a point belongs to: 0 none, -1 a hidden one, else its index + 1.
// Threshold segments test the interpolated value, the others a texture of their ids.
// Keep RANGES in sync with `gl/ray_marcher.ts`.

#define RANGES 16

// low and high biased value, 1 where visible
uniform vec3 rangeBounds[RANGES];
uniform vec3 rangeColours[RANGES];
uniform int rangeCount;

#ifdef LABELS
uniform sampler3D labelTexture;
// colour of each id (linear); alpha 1 where its voxels are drawn, 0.5 where nothing is
uniform sampler2D labelColours;

int labelAt(vec3 grid) {
  return int(texture(labelTexture, grid * textureScale + textureOffset).r * 255.0 + 0.5);
}
#endif

int segmentAt(vec3 grid, float value) {
  int found = 0;
  for (int i = 0; i < RANGES; ++i) {
    if (i >= rangeCount) {
      break;
    }
    vec3 bounds = rangeBounds[i];
    if (bounds.x <= value && value <= bounds.y) {
      if (bounds.z > 0.5) {
        return i + 1;
      }
      found = -1;
    }
  }
#ifdef LABELS
  int label = labelAt(grid);
  float drawn = label > 0 ? texelFetch(labelColours, ivec2(label, 0), 0).a : 0.0;
  if (drawn > 0.75) {
    return RANGES + label;
  }
  found = drawn > 0.25 ? -1 : found;
#endif
  return found;
}

vec3 segmentColour(int segment) {
#ifdef LABELS
  if (segment > RANGES) {
    return texelFetch(labelColours, ivec2(segment - RANGES, 0), 0).rgb;
  }
#endif
  return rangeColours[segment - 1];
}

bool insideSegment(vec3 grid, int segment) {
  return segmentAt(grid, biasedAt(grid)) == segment;
}
