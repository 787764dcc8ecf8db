// How much of the light a cell keeps over the length of its edge: the mean of what is drawn at some
// places of it, as the ray caster draws it.

layout(location = 0) out vec4 opacity;

uniform vec2 grey;

const int samples = 3;
// extinction times edge from which on a part of a cell lets nothing through
const float full = 9.0;
// a translucent surface keeps its share over this length of the body in it [mm]
const float bodyLength = 10.0;

// Opacity of the surface that stands for the segment here; 0 where there is none.
float surfaceAt(vec3 grid, float value) {
  int label = 0;
#ifdef LABELS
  label = labelAt(grid);
  float told = label > 0 ? texelFetch(labelColours, ivec2(label, 0), 0).a : 0.0;
  if (0.28 < told && told < 0.6) {
    return clamp((told - 0.3) / 0.25, 0.0, 1.0);
  }
#endif
  for (int i = 0; i < RANGES; ++i) {
    if (i < rangeCount && rangeBounds[i].z < 0.0 && insideRange(grid, value, label, rangeBounds[i])) {
      return min(-rangeBounds[i].z, 1.0);
    }
  }
  return 0.0;
}

// Extinction of what is drawn at a place [1/mm].
float extinctionAt(vec3 grid) {
  if (isCutAway(grid)) {
    return 0.0;
  }
  float value = biasedAt(grid);
  int segment = segmentAt(grid, value);
  if (segment < 0) {
    float surface = surfaceAt(grid, value);
    return surface > 0.99 ? full : -log(1.0 - surface) / bodyLength;
  }
  if (isSolid(segment)) {
    return full;
  }
#if BLEND == ISO
  return value * grey.x + grey.y >= 0.0 ? full : 0.0;
#else
  float extinction = tissueAt(value * transferScale.x + transferScale.y).a * density;
  return extinction > 0.0 ? extinction * mix(edge.y, 1.0, smoothstep(0.0, edge.x, length(gradientAt(grid)))) : 0.0;
#endif
}

void main() {
  bool skips = bricksTellAll();
  float sum = 0.0;
  for (int i = 0; i < samples * samples * samples; ++i) {
    vec3 part = (vec3(i % samples, (i / samples) % samples, i / (samples * samples)) + 0.5) / float(samples) - 0.5;
    vec3 grid = (cellPlace() + part / cells) * dimensions;
    if (skips && emptyBricks(grid) > 0.0) {
      continue;
    }
    sum += min(full, extinctionAt(grid) * cellEdge);
  }
  opacity = vec4(1.0 - exp(-sum / float(samples * samples * samples)), 0.0, 0.0, 1.0);
}
