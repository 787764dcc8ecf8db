// Tissue and solid segments as they are seen first, until the program that shows all of it is made
// (gl/march/march_program.ts): the same models and the same light with less refinement, and without shade. Opacity is
// told by the values of samples, and a solid segment begins where the value between two samples becomes its own.

Seen seenAlong(Ray ray, inout Layers layers) {
  Seen seen = Seen(vec3(0.0), 1.0, -1.0);
  vec3 toEye = -ray.direction;
  float front = -1.0;
  float t = ray.span.x + ray.start * stepLength;
  int samples = 0;
  while (t < ray.span.y && samples < mostSamples && seen.clarity > clearEnough) {
    float value;
    int segment;
    bool solid;
    vec4 tissue;
    // over what is not seen, in a loop of its own (`OVER_NOTHING` in tissue.glsl)
    bool found = false;
    for (; !found && t < ray.span.y && samples < mostSamples; ++samples) {
      vec3 grid = ray.origin + ray.inGrid * t;
      float leap = stepsOverEmpty(ray, grid, t);
      if (leap > 0.0) {
        front = -1.0;
        t += leap;
        continue;
      }
      value = biasedAt(grid);
      segment = segmentAt(grid, value);
      solid = isSolid(segment);
      tissue = segment < 0 ? vec4(0.0) : tissueAt(value * transferScale.x + transferScale.y);
      found = solid || tissue.a > 0.0;
      if (!found) {
        front = value;
        t += stepLength;
      }
    }
    if (found) {
      float low = segment > 0 ? rangeBounds[segment - 1].x : 0.0;
      bool entered = solid && front >= 0.0 && front < low;
      float place = entered ? t - stepLength * (value - low) / (value - front) : t;
      vec3 gradient = gradientAt(ray.origin + ray.inGrid * place);
      float boundary = smoothstep(0.0, edge.x, length(gradient));
      vec3 normal = facing(gradient, toEye, toEye);
      vec3 own = segment > 0 ? segmentColour(segment) : tissue.rgb;
      float extinction = density * tissue.a * mix(edge.y, 1.0, boundary);
      float opacity = solid ? 1.0 : 1.0 - exp(-extinction * stepLength);
#if BLEND == SHADED
      vec2 factors = segmentMaterial(segment);
      vec3 colour = solid
        ? litSurface(own, normal, toEye, 1.0, vec2(1.0), factors)
        : litTissue(own, normal, toEye, boundary, vec2(1.0), factors);
#else
      vec3 colour = solid ? litSurface(own, normal, toEye, 1.0, vec2(1.0), segmentMaterial(segment)) : own;
#endif
      seen.light += seen.clarity * opacity * colour;
      seen.clarity *= 1.0 - opacity;
      seen.depth = seen.depth < 0.0 && seen.clarity < 0.5 ? place : seen.depth;
      front = value;
      t += stepLength;
    }
  }
  return seen;
}
