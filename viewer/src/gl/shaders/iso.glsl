// The surface where the scan has one value, found to 1/32 of a step, and solid segments beside it.
// Source: Hadwiger et al., "Real-time ray-casting and advanced shading of discrete isosurfaces",
// Computer Graphics Forum 24 (2005).

uniform vec3 isoColour;

bool enclosed(vec3 grid, out int segment) {
  float value = biasedAt(grid);
  segment = segmentAt(grid, value);
  if (segment >= 0 && !isSolid(segment)) {
    segment = value * grey.x + grey.y >= 0.0 ? isoSegment : 0;
  }
  return segment == isoSegment || segment > 0;
}

Seen seenAlong(Ray ray, inout Layers layers) {
  Seen seen = Seen(vec3(0.0), 1.0, -1.0);
  float last = ray.span.x;
  float t = last + ray.start * stepLength;
  for (int i = 0; i < 8192; ++i) {
    if (last >= ray.span.y) {
      break;
    }
    t = min(t, ray.span.y);
    float leap = stepsOverEmpty(ray, ray.origin + ray.inGrid * t, t);
    if (leap > 0.0) {
      t += leap;
      last = t - stepLength;
      continue;
    }
    int segment;
    if (!enclosed(ray.origin + ray.inGrid * t, segment)) {
      last = t;
      t += stepLength;
      continue;
    }
    int here;
    bool cut = last <= ray.span.x && enclosed(ray.origin + ray.inGrid * last, here);
    float end = cut ? last : t;
    segment = cut ? here : segment;
    for (int j = 0; j < refinements && !cut; ++j) {
      float middle = 0.5 * (last + end);
      if (enclosed(ray.origin + ray.inGrid * middle, here)) {
        end = middle;
        segment = here;
      } else {
        last = middle;
      }
    }
    passLayers(layers, end, seen.light, seen.clarity, seen.depth);
    vec3 grid = ray.origin + ray.inGrid * end;
    vec3 toEye = -ray.direction;
    if (segment == isoSegment) {
      vec3 normal = cut ? ray.face : facing(gradientAt(grid), toEye, toEye);
      seen.light += seen.clarity * litSurface(isoColour, normal, toEye, openness(grid, normal, segment), lightAt(grid, normal));
    } else {
      seen.light += seen.clarity * lightOfSegment(ray, grid, segment, cut);
    }
    seen.clarity = 0.0;
    seen.depth = seen.depth < 0.0 ? end : seen.depth;
    break;
  }
  return seen;
}
