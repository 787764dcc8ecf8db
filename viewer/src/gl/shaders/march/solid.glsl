// Surfaces of segments along a ray, found between two samples, and their normals.

const int refinements = 5;

// Where between two samples the ray enters a solid segment, and which: where segments lie in one
// another it is the outer one, however steep the step between.
float refinedEntry(Ray ray, float before, float inside, inout int segment) {
  for (int i = 0; i < refinements; ++i) {
    float middle = 0.5 * (before + inside);
    vec3 grid = ray.origin + ray.inGrid * middle;
    int here = seenSegmentAt(grid, biasedAt(grid));
    if (isSolid(here)) {
      inside = middle;
      segment = here;
    } else {
      before = middle;
    }
  }
  return inside;
}

#ifdef SECOND
// Whether a cell's side cuts a solid segment where a ray enters it; that is the face of the cut then.
bool cutByCell(inout Ray ray, vec3 grid) {
  vec3 before;
  vec3 face;
  if (!cameFromNextCell(ray, grid, before, face) || !isSolid(segmentAt(before, biasedAt(before)))) {
    return false;
  }
  ray.face = face;
  return true;
}
#endif

#ifdef LABELS
// Outward normal of a label, from the share of its voxels around the point.
vec3 labelNormal(vec3 grid, int label) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 27; ++i) {
    vec3 offset = vec3(i % 3, (i / 3) % 3, i / 9) - 1.0;
    vec3 place = grid + 1.5 * offset * sampleStep;
    sum -= float(labelAt(place) == label) * offset / spacing;
  }
  return sum;
}
#endif

vec3 surfaceNormal(vec3 grid, int segment) {
#ifdef LABELS
  if (segment > RANGES) {
    return labelNormal(grid, segment - RANGES);
  }
  vec4 bounds = rangeBounds[segment - 1];
  if (bounds.w > 0.5 && editedAround(grid, bounds)) {
    return labelNormal(grid, int(bounds.w));
  }
#endif
  return gradientAt(grid);
}

// Light of a solid segment at a point, seen through one of the faces that cut it or not.
vec3 lightOfSegment(Ray ray, vec3 grid, int segment, bool cut) {
  vec3 toEye = -ray.direction;
  vec3 normal = cut ? ray.face : facing(surfaceNormal(grid, segment), toEye, toEye);
  float open = nearOpenness(grid, normal, segment);
  return litSurface(segmentColour(segment), normal, toEye, open, lightAt(grid, normal), segmentMaterial(segment));
}
