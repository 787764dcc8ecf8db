// Tissue by absorption and emission, front to back. Between two samples the transfer function is
// integrated over the values between theirs, so the step changes cost and not look; where tissue
// becomes opaque, steps are quartered. Solid segments end the ray at their surface.
// Source: Max, "Optical models for direct volume rendering", IEEE TVCG 1 (1995); Engel et al.,
// "Real-Time Volume Graphics" (2006), ch. 4 (pre-integration by integral functions); Levoy, "Display
// of surfaces from volume data", IEEE CG&A 8 (1988) for the weight of boundaries.

// opacity of a whole step from which on it is quartered, and for how many quarters
const float opaqueStep = 0.12;
const int quarters = 4;
const float unknown = -1e9;

// Tissue of a segment or of none as it is lit, weighted by the boundary that it is here.
vec4 litFirst(vec3 grid, vec3 toEye, vec4 tissue, int segment) {
  tissue.a *= density;
#if BLEND == SHADED || BLEND == COMPOSITE
  if (tissue.a <= 0.0) {
    return vec4(0.0);
  }
  vec3 gradient = gradientAt(grid);
  float boundary = smoothstep(0.0, edge.x, length(gradient));
  tissue.a *= mix(edge.y, 1.0, boundary);
#if BLEND == SHADED
  vec3 normal = facing(gradient, toEye, toEye);
  vec2 light = lightAt(grid, normal * boundary);
  tissue.rgb = litTissue(tissue.rgb, normal, toEye, boundary, light, segmentMaterial(segment));
#endif
#endif
  return tissue;
}

// Adds the light of an interval of tissue; false where it is too opaque for its length.
bool addTissue(Ray ray, vec2 interval, vec4 tissue, int segment, bool dividable, inout Layers layers, inout Seen seen) {
  float size = interval.y - interval.x;
  float middle = 0.5 * (interval.x + interval.y);
  vec3 grid = ray.origin + ray.inGrid * middle;
  vec3 toEye = -ray.direction;
#ifdef SECOND
  tissue.a = isSecondsTurn(grid) ? 0.0 : tissue.a;
  vec4 seenHere = mixed(litFirst(grid, toEye, tissue, segment), litSecond(grid, toEye));
#else
  vec4 seenHere = litFirst(grid, toEye, tissue, segment);
#endif
  float extinction = seenHere.a;
#if BLEND == SHADED || BLEND == COMPOSITE
  if (dividable && extinction * stepLength > opaqueStep) {
    return false;
  }
#endif
  passLayers(layers, middle, seen.light, seen.clarity, seen.depth);
#if BLEND == EMISSION
  seen.light += seen.clarity * extinction * size * seenHere.rgb;
#else
  float opacity = 1.0 - exp(-extinction * size);
#if BLEND == ABSORPTION
  // what is absorbed of the light behind, bright where much is: as a radiograph shows it
  vec3 colour = vec3(1.0);
#else
  vec3 colour = seenHere.rgb;
#endif
  seen.light += seen.clarity * opacity * colour;
  seen.clarity *= 1.0 - opacity;
#if BLEND != ABSORPTION
  seen.depth = seen.depth < 0.0 && seen.clarity < 0.5 ? interval.y : seen.depth;
#endif
#endif
  return true;
}

#ifdef SECOND
// Goes where the second scan is and the first is not.
void passSecond(Ray ray, vec2 span, inout Layers layers, inout Seen seen) {
  float last = span.x;
  float t = last + ray.start * stepLength;
  bool wasEmpty = true;
  int fine = 0;
  for (int i = 0; i < mostSamples; ++i) {
    if (last >= span.y || seen.clarity <= clearEnough) {
      break;
    }
    t = min(t, span.y);
    float leap = stepsOverSecond(ray, ray.origin + ray.inGrid * t);
    if (leap > 0.0 && wasEmpty) {
      t += leap;
      last = t - stepLength;
      fine = 0;
      continue;
    }
    bool dividable = fine == 0 && t - last > 0.3 * stepLength;
    if (!addTissue(ray, vec2(last, t), vec4(0.0), 0, dividable, layers, seen)) {
      fine = quarters;
      t = last + 0.25 * stepLength;
      continue;
    }
    wasEmpty = leap > 0.0;
    last = t;
    fine = max(0, fine - 1);
    t += fine > 0 ? 0.25 * stepLength : stepLength;
  }
}
#endif

// How far a ray was followed: up to `last`, with the value there or `unknown`. The next sample is at `t`; so many steps
// from there on are quarters.
struct March {
  float last;
  float front;
  float t;
  int fine;
  int samples;
#ifdef SURFACES
  Shells shells;
#endif
};

// What is found between `last` and `t`: nothing that is seen, tissue, or a surface that comes before it.
const int nothing = 0;
const int justTissue = 1;
const int someSurface = 2;

struct Found {
  int what;
  // mean on the way
  vec4 tissue;
  // there at the end
  float value;
  int segment;
  bool inEmptyBrick;
#ifdef SURFACES
  Shells shells;
#endif
};

void goOn(Found found, inout March march) {
  // an empty brick is leapt over from here on
  march.front = found.inEmptyBrick ? unknown : found.value;
  march.last = march.t;
  march.fine = max(0, march.fine - 1);
  march.t += march.fine > 0 ? 0.25 * stepLength : stepLength;
}

// Lets the light of the tissue in that was found; false where it is too opaque for the length of the way.
bool addFound(Ray ray, March march, Found found, inout Layers layers, inout Seen seen) {
  int segment = isSolid(found.segment) ? 0 : found.segment;
  vec4 tissue = found.tissue;
  if (segment > 0) {
    tissue.rgb = segmentColour(segment);
  }
  bool dividable = march.fine == 0 && march.t - march.last > 0.3 * stepLength;
  return addTissue(ray, vec2(march.last, march.t), tissue, segment, dividable, layers, seen);
}

bool isUnderWay(Ray ray, March march, Seen seen) {
  return march.last < ray.span.y && seen.clarity > clearEnough && march.samples < mostSamples;
}

// Looks at a ray's next sample, or leaps over an empty brick; `solid` is the segment that ends the ray, or 0. What is
// not seen is left behind, and so is tissue that nothing shines on: it costs little, and its light is let in at once.
void look(Ray ray, int solid, inout March march, inout Found found, inout Layers layers, inout Seen seen) {
  march.samples += 1;
  march.t = min(march.t, ray.span.y);
  vec3 grid = ray.origin + ray.inGrid * march.t;
  float leap = stepsOverEmpty(ray, grid, march.t);
#ifdef SECOND
  leap = min(leap, stepsOverSecond(ray, grid));
  const bool beside = true;
#else
  const bool beside = false;
#endif
  if (leap > 0.0 && march.front == unknown) {
    march.t += leap;
    march.last = march.t - stepLength;
    march.fine = 0;
    return;
  }
  march.front = march.front == unknown ? biasedAt(ray.origin + ray.inGrid * march.last) : march.front;
  found.value = biasedAt(grid);
  found.segment = seenSegmentAt(grid, found.value);
  found.tissue = tissueBetween(march.front, found.value);
  found.inEmptyBrick = leap > 0.0;
  found.what = found.segment >= 0 && (found.tissue.a > 0.0 || beside) ? justTissue : nothing;
#if BLEND == SHADED || BLEND == COMPOSITE
  found.what = solid == 0 && isSolid(found.segment) ? someSurface : found.what;
#endif
#ifdef SURFACES
  if (march.shells.left > 0) {
    found.shells = shellsAt(grid, found.value, march.shells.left);
    found.what = found.shells != march.shells ? someSurface : found.what;
  }
#endif
#if BLEND == ABSORPTION || BLEND == EMISSION
  if (found.what == justTissue) {
    addFound(ray, march, found, layers, seen);
    found.what = nothing;
  }
#endif
  if (found.what == nothing) {
    march.fine = 0;
    goOn(found, march);
  }
}

// A CPU works through all of a loop's body for all rays of a group, whichever branches are taken: there rays go over
// nothing in a loop of its own. A GPU leaves out what none of them does, and its rays would wait for each other.
// Source: Aila and Laine, "Understanding the efficiency of ray traversal on GPUs", HPG (2009).
#ifdef CPU_DRAWS
#define OVER_NOTHING while
#else
#define OVER_NOTHING if
#endif

// Follows a ray through tissue to the next surface, or to its end.
void passTissue(Ray ray, int solid, inout March march, inout Found found, inout Layers layers, inout Seen seen) {
  do {
    found.what = nothing;
    OVER_NOTHING (found.what == nothing && isUnderWay(ray, march, seen)) {
      look(ray, solid, march, found, layers, seen);
    }
#if BLEND == SHADED || BLEND == COMPOSITE
    if (found.what == justTissue) {
      if (addFound(ray, march, found, layers, seen)) {
        goOn(found, march);
      } else {
        march.fine = quarters;
        march.t = march.last + 0.25 * stepLength;
      }
    }
#endif
  } while (found.what != someSurface && isUnderWay(ray, march, seen));
}

// From surface to surface, each of which is met outside of the loop through tissue.
Seen seenAlong(Ray ray, inout Layers layers) {
  Seen seen = Seen(vec3(0.0), 1.0, -1.0);
#ifdef SECOND
  vec2 first = ray.span.y > ray.span.x ? ray.span : vec2(farAway);
  passSecond(ray, vec2(ray.other.x, min(ray.other.y, first.x)), layers, seen);
#endif
  March march;
  march.last = ray.span.x;
  march.front = unknown;
  march.t = ray.span.x + ray.start * stepLength;
  march.fine = 0;
  march.samples = 0;
#ifdef SURFACES
  march.shells = enterShells(ray, layers, seen);
#endif
  Found found;
  // the segment that ends the ray, and whether a face cuts it there
  int solid = 0;
  bool cut = false;
  do {
    passTissue(ray, solid, march, found, layers, seen);
    if (found.what == someSurface) {
#ifdef SURFACES
      if (passShells(ray, vec2(march.last, march.t), found.shells, false, march.shells, layers, seen)) {
        continue;
      }
#endif
#if BLEND == SHADED || BLEND == COMPOSITE
      solid = found.segment;
      cut = march.last <= ray.span.x && isSolid(seenSegmentAt(ray.origin + ray.inGrid * march.last, march.front));
      ray.span.y = cut ? march.last : refinedEntry(ray, march.last, march.t, solid);
#endif
    }
  } while (found.what == someSurface);
#if BLEND == SHADED || BLEND == COMPOSITE
  if (solid > 0 && seen.clarity > clearEnough) {
    vec3 grid = ray.origin + ray.inGrid * ray.span.y;
#ifdef SECOND
    cut = cut || cutByCell(ray, grid);
#endif
    passLayers(layers, ray.span.y, seen.light, seen.clarity, seen.depth);
    seen.light += seen.clarity * lightOfSegment(ray, grid, solid, cut);
    seen.clarity = 0.0;
    seen.depth = seen.depth < 0.0 ? ray.span.y : seen.depth;
  }
#endif
#ifdef SECOND
  passSecond(ray, vec2(max(ray.other.x, first.y), ray.other.y), layers, seen);
#endif
  return seen;
}
