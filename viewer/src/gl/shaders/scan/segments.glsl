// Which segment a point belongs to: 0 none, -1 a hidden one, else its index + 1.
// Threshold segments test the interpolated value, the others a texture of their ids. Where a
// threshold segment was edited the ids decide too, but only beside voxels whose id is not what
// their value says: so an edit brings steps of voxels where it was, and nowhere else.
// Keep RANGES in sync with `gl/march/ray_marcher.ts`.

#define RANGES 32

// low and high biased value; 2 where solid, 1 where tissue in its colour, 0 where left out, less by the
// opacity of the surface that stands for it; and its id where it was edited, else 0
uniform vec4 rangeBounds[RANGES];
uniform vec3 rangeColours[RANGES];
// factors on ambient and specular light, and the opacity of the body that can stand for its surface, 0 where none can
uniform vec3 rangeMaterials[RANGES];
uniform int rangeCount;
// 1 where bodies stand for surfaces that have them
uniform int bodies;

#ifdef LABELS
uniform sampler3D labelTexture;
// colour of each id (linear); alpha 1 where its voxels are solid, 0.75 where tissue in its colour,
// 0.3 where nothing is drawn, and up to 0.55 by how opaque its surface is, 0 where there is no such segment or a
// range tells of it; in a second row what `rangeMaterials` tells of others
uniform sampler2D labelColours;

int labelAt(vec3 grid) {
  return int(texture(labelTexture, atRest(grid) * textureScale + textureOffset).r * 255.0 + 0.5);
}

// Whether the id of a voxel around a point is not what its value says.
bool editedAround(vec3 grid, vec4 bounds) {
  ivec3 size = textureSize(labelTexture, 0);
  ivec3 first = ivec3(floor((atRest(grid) * textureScale + textureOffset) * vec3(size) - 0.5));
  for (int i = 0; i < 8; ++i) {
    ivec3 texel = clamp(first + ivec3(i & 1, i >> 1 & 1, i >> 2), ivec3(0), size - 1);
    float value = biasedOf(texel);
    int label = int(texelFetch(labelTexture, texel, 0).r * 255.0 + 0.5);
    if ((bounds.x <= value && value <= bounds.y) != (label == int(bounds.w))) {
      return true;
    }
  }
  return false;
}
#endif

bool insideRange(vec3 grid, float value, int label, vec4 bounds) {
  bool byValue = bounds.x <= value && value <= bounds.y;
#ifdef LABELS
  bool byLabel = label == int(bounds.w);
  if (bounds.w > 0.5 && byValue != byLabel) {
    return editedAround(grid, bounds) ? byLabel : byValue;
  }
#endif
  return byValue;
}

bool isOpaqueBody(float opacity) {
  return bodies == 1 && opacity == 1.0;
}

int segmentAt(vec3 grid, float value) {
  int found = 0;
  int label = 0;
#ifdef LABELS
  label = labelAt(grid);
#endif
  for (int i = 0; i < RANGES; ++i) {
    if (i >= rangeCount) {
      break;
    }
    vec4 bounds = rangeBounds[i];
    if (insideRange(grid, value, label, bounds)) {
      if (bounds.z > 0.5 || isOpaqueBody(rangeMaterials[i].z)) {
        return i + 1;
      }
      found = -1;
    }
  }
#ifdef LABELS
  float drawn = label > 0 ? texelFetch(labelColours, ivec2(label, 0), 0).a : 0.0;
  if (drawn > 0.6 || isOpaqueBody(texelFetch(labelColours, ivec2(label, 1), 0).b)) {
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

// Factors of a segment on ambient and specular light, and the opacity of its body; what is in none has its light as it
// is.
vec3 toldOf(int segment) {
  if (segment <= 0) {
    return vec3(1.0, 1.0, 0.0);
  }
#ifdef LABELS
  if (segment > RANGES) {
    return texelFetch(labelColours, ivec2(segment - RANGES, 1), 0).rgb;
  }
#endif
  return rangeMaterials[segment - 1];
}

vec2 segmentMaterial(int segment) {
  return toldOf(segment).xy;
}

// Opacity of the body that can stand for a segment's surface.
float bodyOpacity(int segment) {
  return toldOf(segment).z;
}

// Whether a segment that is drawn is a solid body, and no tissue in its colour.
bool isSolid(int segment) {
  if (segment <= 0) {
    return false;
  }
#ifdef LABELS
  if (segment > RANGES) {
    return texelFetch(labelColours, ivec2(segment - RANGES, 0), 0).a > 0.9 || isOpaqueBody(bodyOpacity(segment));
  }
#endif
  return rangeBounds[segment - 1].z > 1.5 || isOpaqueBody(bodyOpacity(segment));
}
