// One value of all along a ray, as grey by window and level: the largest (MIP), the least (MinIP) or
// the mean. The last two count from the first to the last tissue on the ray: air around the body
// would hide all of it. A second scan has a value of its own, by its own window, in its colour over that.
// Source: Wallis et al., "Three-dimensional display in nuclear medicine", IEEE TMI 8 (1989) for MIP.

// share of the window from which on there is tissue
uniform float tissueFrom;
#ifdef SECOND
uniform float secondTissueFrom;
// share of its window at a biased value: x per value, y at 0
uniform vec2 secondRayGrey;
// depth of the middle of the view [mm]
uniform float middleDepth;

// Whether a ray shows the second scan alone: in squares of the plane through the middle of the view, or in time.
bool isSecondsRay(Ray ray) {
  if (secondViewFusion == 0 || ray.other.y <= ray.other.x) {
    return false;
  }
  vec2 place = (gl_FragCoord.xy + shift.xy) / pictureSize * 2.0 - 1.0;
  vec2 inPlane = place * vec2(length(across), length(upward)) * (parallel > 0.5 ? 1.0 : middleDepth);
  return secondViewFusion == 1 ? isOdd(vec3(inPlane / secondSquare, 0.0)) : secondTurn > 0.5;
}
#endif

// no share of a window
const float none = 1e9;

vec3 linearFromScreen(vec3 colour) {
  vec3 c = clamp(colour, 0.0, 1.0);
  return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, lessThanEqual(c, vec3(0.04045)));
}

// Share of the window at a place; -none where nothing counts.
float shareAt(vec3 grid, bool second) {
#ifdef SECOND
  if (second) {
    return secondBiased(placeOnSecond(grid)) * secondRayGrey.x + secondRayGrey.y;
  }
#endif
  float value = biasedAt(grid);
  return segmentAt(grid, value) < 0 ? -none : value * grey.x + grey.y;
}

#if BLEND == MIP || BLEND == MINIP
// The largest value beside a sample, or the least: a thin bone, or an airway, lies between two of them.
// What counts lies in `counted`, or is tissue.
float refined(Ray ray, vec2 span, vec2 counted, float from, bool second, float place, float found) {
  float reach = 0.5 * stepLength;
  for (int i = 0; i < 4 && found > 0.0 && found < 1.0; ++i) {
    for (int side = -1; side <= 1; side += 2) {
      float t = place + float(side) * reach;
      float share = shareAt(ray.origin + ray.inGrid * t, second);
#if BLEND == MIP
      bool beyond = share > found;
#else
      bool counts = share >= from || (counted.x <= t && t <= counted.y);
      bool beyond = share < found && share != -none && counts;
#endif
      if (beyond && span.x <= t && t <= span.y) {
        found = share;
        place = t;
      }
    }
    reach *= 0.5;
  }
  return found;
}
#endif

// The share of one scan; -none where none of it counts.
float shareAlong(Ray ray, vec2 span, bool second) {
  float from = tissueFrom;
#ifdef SECOND
  // a slab is inside of the body: there all counts
  from = !second ? from : slab.y < farAway ? -none : secondTissueFrom;
#endif
  float most = -none;
  float place = 0.0;
  // of what counts, and of what counts as soon as tissue comes after it
  float least = none;
  float leastWaiting = none;
  float placeWaiting = 0.0;
  // from the first tissue to the last
  vec2 counted = vec2(0.0);
  vec2 sum = vec2(0.0);
  vec2 sumWaiting = vec2(0.0);
  float t = span.x + ray.start * stepLength;
  for (int i = 0; i < mostSamples; ++i) {
    if (t >= span.y) {
      break;
    }
    vec3 grid = ray.origin + ray.inGrid * t;
#ifdef SECOND
    float leap = second ? stepsOverSecond(ray, grid) : stepsOverEmpty(ray, grid, t);
#else
    float leap = stepsOverEmpty(ray, grid, t);
#endif
    float before = t;
    t += leap > 0.0 ? leap : stepLength;
    if (leap > 0.0) {
      continue;
    }
    float share = shareAt(grid, second);
    if (share == -none) {
      continue;
    }
#if BLEND == MIP
    if (share > most) {
      most = share;
      place = before;
    }
    if (most >= 1.0) {
      break;
    }
#else
    bool tissue = share >= from;
    if (tissue || least < none) {
      placeWaiting = share < leastWaiting ? before : placeWaiting;
      leastWaiting = min(leastWaiting, share);
      sumWaiting += vec2(share, 1.0);
    }
    if (tissue) {
      counted = vec2(least < none ? counted.x : before, before);
      place = leastWaiting < least ? placeWaiting : place;
      least = min(least, leastWaiting);
      sum += sumWaiting;
      sumWaiting = vec2(0.0);
      leastWaiting = none;
    }
#endif
  }
#if BLEND == MIP
  return refined(ray, span, span, from, second, place, most);
#elif BLEND == MINIP
  return least < none ? refined(ray, span, counted, from, second, place, least) : -none;
#else
  return sum.y > 0.0 ? sum.x / sum.y : -none;
#endif
}

Seen seenAlong(Ray ray, inout Layers layers) {
  vec3 shown = vec3(clamp(shareAlong(ray, ray.span, false), 0.0, 1.0));
#ifdef SECOND
  float other = shareAlong(ray, ray.other, true);
#if BLEND == MIP
  // black may have been leapt over
  const float least = 0.0;
#else
  const float least = -none;
#endif
  if (isSecondsRay(ray)) {
    shown = tinted(clamp(other, 0.0, 1.0));
  } else if (secondViewFusion == 0 && other > least) {
    shown = blended(shown, clamp(other, 0.0, 1.0));
  }
#endif
  // black is as clear as air: the page's own ground shows through
  return Seen(linearFromScreen(shown), 1.0 - max(max(shown.r, shown.g), shown.b), -1.0);
}
