// One value of all along a ray, as grey by window and level: the largest (MIP), the least (MinIP) or
// the mean. The last two count from the first to the last tissue on the ray: air around the body
// would hide all of it.
// Source: Wallis et al., "Three-dimensional display in nuclear medicine", IEEE TMI 8 (1989) for MIP.

// share of the window from which on there is tissue
uniform float tissueFrom;

vec3 linearFromGrey(float share) {
  float s = clamp(share, 0.0, 1.0);
  return vec3(s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4));
}

#if BLEND == MIP
// The largest value beside a sample: a thin bone lies between two of them.
float refinedMost(Ray ray, float place, float most) {
  float reach = 0.5 * stepLength;
  for (int i = 0; i < 4 && most > 0.0 && most < 1.0; ++i) {
    for (int side = -1; side <= 1; side += 2) {
      float t = place + float(side) * reach;
      vec3 grid = ray.origin + ray.inGrid * t;
      float value = biasedAt(grid);
      float share = value * grey.x + grey.y;
      if (share > most && ray.span.x <= t && t <= ray.span.y && segmentAt(grid, value) >= 0) {
        most = share;
        place = t;
      }
    }
    reach *= 0.5;
  }
  return most;
}
#endif

Seen seenAlong(Ray ray, inout Layers layers) {
  const float none = 1e9;
  float most = -none;
  float place = 0.0;
  // of what counts, and of what counts as soon as tissue comes after it
  float least = none;
  float leastWaiting = none;
  vec2 sum = vec2(0.0);
  vec2 sumWaiting = vec2(0.0);
  float t = ray.span.x + ray.start * stepLength;
  for (int i = 0; i < 8192; ++i) {
    if (t >= ray.span.y) {
      break;
    }
    vec3 grid = ray.origin + ray.inGrid * t;
    float leap = stepsOverEmpty(ray, grid, t);
    float before = t;
    t += leap > 0.0 ? leap : stepLength;
    if (leap > 0.0) {
      continue;
    }
    float value = biasedAt(grid);
    if (segmentAt(grid, value) < 0) {
      continue;
    }
    float share = value * grey.x + grey.y;
#if BLEND == MIP
    if (share > most) {
      most = share;
      place = before;
    }
    if (most >= 1.0) {
      break;
    }
#else
    bool tissue = share >= tissueFrom;
    if (tissue || least < none) {
      leastWaiting = min(leastWaiting, share);
      sumWaiting += vec2(share, 1.0);
    }
    if (tissue) {
      least = min(least, leastWaiting);
      sum += sumWaiting;
      sumWaiting = vec2(0.0);
      leastWaiting = none;
    }
#endif
  }
#if BLEND == MIP
  float share = refinedMost(ray, place, most);
#elif BLEND == MINIP
  float share = least < none ? least : 0.0;
#else
  float share = sum.y > 0.0 ? sum.x / sum.y : 0.0;
#endif
  // black is as clear as air: the page's own ground shows through
  return Seen(linearFromGrey(share), 1.0 - clamp(share, 0.0, 1.0), -1.0);
}
