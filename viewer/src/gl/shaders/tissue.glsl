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
  tissue.rgb = litTissue(tissue.rgb, normal, toEye, boundary, lightAt(grid, normal * boundary), segmentMaterial(segment));
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
  for (int i = 0; i < 8192; ++i) {
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

Seen seenAlong(Ray ray, inout Layers layers) {
  Seen seen = Seen(vec3(0.0), 1.0, -1.0);
#ifdef SECOND
  vec2 first = ray.span.y > ray.span.x ? ray.span : vec2(farAway);
  passSecond(ray, vec2(ray.other.x, min(ray.other.y, first.x)), layers, seen);
#endif
#ifdef SURFACES
  Shells shells = enterShells(ray, layers, seen);
#endif
  // up to here the ray is done, and the value there
  float last = ray.span.x;
  float front = unknown;
  float t = last + ray.start * stepLength;
  int fine = 0;
  for (int i = 0; i < 8192; ++i) {
    if (last >= ray.span.y || seen.clarity <= clearEnough) {
      break;
    }
    t = min(t, ray.span.y);
    vec3 grid = ray.origin + ray.inGrid * t;
    float leap = stepsOverEmpty(ray, grid, t);
#ifdef SECOND
    leap = min(leap, stepsOverSecond(ray, grid));
    const bool beside = true;
#else
    const bool beside = false;
#endif
    if (leap > 0.0 && front == unknown) {
      t += leap;
      last = t - stepLength;
      fine = 0;
      continue;
    }

    float value = biasedAt(grid);
    int segment = seenSegmentAt(grid, value);
    bool dividable = fine == 0;
#ifdef SURFACES
    dividable = !passShells(ray, vec2(last, t), value, false, shells, layers, seen) && dividable;
#endif
    if (segment < 0) {
      // what is left out has no skin either
      front = value;
      last = t;
      t += stepLength;
      fine = 0;
      continue;
    }
    float first = front == unknown ? biasedAt(ray.origin + ray.inGrid * last) : front;
    float end = t;
#if BLEND == SHADED || BLEND == COMPOSITE
    bool solid = isSolid(segment);
    bool cut = false;
    if (solid) {
      vec3 before = ray.origin + ray.inGrid * last;
      cut = last <= ray.span.x && isSolid(seenSegmentAt(before, first));
      end = cut ? last : refinedEntry(ray, last, t, segment);
      grid = ray.origin + ray.inGrid * end;
      value = biasedAt(grid);
#ifdef SECOND
      cut = cut || cutByCell(ray, grid);
#endif
    }
#else
    const bool solid = false;
#endif
    vec4 tissue = tissueBetween(first, value);
    if ((tissue.a > 0.0 || beside) && end > last) {
      if (segment > 0 && !isSolid(segment)) {
        tissue.rgb = segmentColour(segment);
      }
      dividable = dividable && end - last > 0.3 * stepLength;
      if (!addTissue(ray, vec2(last, end), tissue, solid ? 0 : segment, dividable, layers, seen)) {
        front = first;
        fine = quarters;
        t = last + 0.25 * stepLength;
        continue;
      }
    } else {
      fine = 0;
    }
#if BLEND == SHADED || BLEND == COMPOSITE
    if (solid) {
      passLayers(layers, end, seen.light, seen.clarity, seen.depth);
      seen.light += seen.clarity * lightOfSegment(ray, grid, segment, cut);
      seen.clarity = 0.0;
      seen.depth = seen.depth < 0.0 ? end : seen.depth;
      break;
    }
#endif
    // an empty brick is leapt over from here on
    front = leap > 0.0 ? unknown : value;
    last = t;
    fine = max(0, fine - 1);
    t += fine > 0 ? 0.25 * stepLength : stepLength;
  }
#ifdef SECOND
  passSecond(ray, vec2(max(ray.other.x, first.y), ray.other.y), layers, seen);
#endif
  return seen;
}
