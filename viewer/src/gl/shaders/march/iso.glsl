// The surface where the scan has one value, found to 1/32 of a step, and solid segments beside it. That of
// a second scan is seen through as its opacity says.
// Source: Hadwiger et al., "Real-time ray-casting and advanced shading of discrete isosurfaces",
// Computer Graphics Forum 24 (2005).

uniform vec3 isoColour;

bool enclosed(vec3 grid, out int segment) {
  float value = biasedAt(grid);
  segment = seenSegmentAt(grid, value);
  if (segment >= 0 && !isSolid(segment)) {
    segment = value * grey.x + grey.y >= 0.0 ? isoSegment : 0;
  }
#ifdef SECOND
  segment = isSecondsTurn(grid) ? 0 : segment;
#endif
  return segment == isoSegment || segment > 0;
}

#ifdef SECOND
// what its value is above that of its surface: x per biased value, y at 0
uniform vec2 secondIso;
uniform vec3 secondIsoColour;

// Where a ray meets something, and whether it is cut open there, and through which face.
struct Meeting {
  float at;
  bool cut;
  vec3 face;
};

bool insideSecond(vec3 grid) {
  return secondBiased(placeOnSecond(grid)) * secondIso.x + secondIso.y >= 0.0;
}

bool enclosedBySecond(vec3 grid) {
  return showsSecond(grid) && insideSecond(grid);
}

// Whether a cell's side cuts the first scan's body, or the second's, where a ray enters it.
bool opensCell(Ray ray, vec3 grid, bool second, inout vec3 side) {
  vec3 before;
  vec3 face;
  if (!cameFromNextCell(ray, grid, before, face)) {
    return false;
  }
  float value = biasedAt(before);
  int there = segmentAt(before, value);
  bool inFirst = there >= 0 && (isSolid(there) || value * grey.x + grey.y >= 0.0);
  if (second ? !insideSecond(before) : !inFirst) {
    return false;
  }
  side = face;
  return true;
}

Meeting meetSecond(Ray ray) {
  float last = ray.other.x;
  float t = last + ray.start * stepLength;
  bool met = false;
  for (int i = 0; i < mostSamples && !met && last < ray.other.y; ++i) {
    t = min(t, ray.other.y);
    vec3 grid = ray.origin + ray.inGrid * t;
    float leap = stepsOverSecond(ray, grid);
    met = leap == 0.0 && enclosedBySecond(grid);
    if (!met) {
      last = leap > 0.0 ? t + leap - stepLength : t;
      t = last + stepLength;
    }
  }
  if (!met) {
    return Meeting(farAway, false, vec3(0.0));
  }
  bool cut = last <= ray.other.x && enclosedBySecond(ray.origin + ray.inGrid * last);
  float end = cut ? last : t;
  for (int j = 0; j < refinements && !cut; ++j) {
    float middle = 0.5 * (last + end);
    bool inside = enclosedBySecond(ray.origin + ray.inGrid * middle);
    end = inside ? middle : end;
    last = inside ? last : middle;
  }
  vec3 face = ray.otherFace;
  cut = cut || opensCell(ray, ray.origin + ray.inGrid * end, true, face);
  return Meeting(end, cut, face);
}

// Lets the light of its surface in, where that lies before `t`.
void passSecond(Ray ray, Meeting surface, float t, inout Layers layers, inout Seen seen) {
  if (surface.at >= t) {
    return;
  }
  passLayers(layers, surface.at, seen.light, seen.clarity, seen.depth);
  vec3 grid = ray.origin + ray.inGrid * surface.at;
  vec3 toEye = -ray.direction;
  vec3 normal = facing(surface.cut ? surface.face : secondGradient(grid), toEye, toEye);
  // in cells of its own it hides nothing of the first
  float opacity = secondViewFusion == 0 ? secondOpacity : 1.0;
  vec2 light = lightOnSecond(grid, normal);
  seen.light += seen.clarity * opacity * litSurface(secondIsoColour, normal, toEye, 1.0, light, vec2(1.0));
  seen.clarity *= 1.0 - opacity;
  seen.depth = seen.depth < 0.0 && seen.clarity < 0.5 ? surface.at : seen.depth;
}
#endif

Seen seenAlong(Ray ray, inout Layers layers) {
  Seen seen = Seen(vec3(0.0), 1.0, -1.0);
#ifdef SECOND
  Meeting other = meetSecond(ray);
#endif
#ifdef SURFACES
  Shells shells = enterShells(ray, layers, seen);
  Shells now = shells;
#endif
  float last = ray.span.x;
  float t = last + ray.start * stepLength;
  int samples = 0;
  int segment = 0;
  bool met = false;
  // to the surface, from one body that stands for another to the next
  bool crossed = false;
  do {
    crossed = false;
    for (; !met && !crossed && last < ray.span.y && samples < mostSamples; ++samples) {
      t = min(t, ray.span.y);
      vec3 grid = ray.origin + ray.inGrid * t;
      float leap = stepsOverEmpty(ray, grid, t);
      met = leap == 0.0 && enclosed(grid, segment);
#ifdef SURFACES
      if (shells.left > 0) {
        now = shellsAt(grid, biasedAt(grid), shells.left);
        crossed = now != shells;
      }
#endif
      if (!met && !crossed) {
        last = leap > 0.0 ? t + leap - stepLength : t;
        t = last + stepLength;
      }
    }
#ifdef SURFACES
    if (crossed) {
      passShells(ray, vec2(last, t), now, false, shells, layers, seen);
      met = false;
    }
#endif
  } while (crossed);
  if (met) {
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
#ifdef SECOND
    passSecond(ray, other, end, layers, seen);
    other.at = farAway;
#endif
    passLayers(layers, end, seen.light, seen.clarity, seen.depth);
    vec3 grid = ray.origin + ray.inGrid * end;
#ifdef SECOND
    cut = cut || opensCell(ray, grid, false, ray.face);
#endif
    vec3 toEye = -ray.direction;
    if (segment == isoSegment) {
      vec3 normal = cut ? ray.face : facing(gradientAt(grid), toEye, toEye);
      float open = nearOpenness(grid, normal, segment);
      vec2 light = lightAt(grid, normal);
      seen.light += seen.clarity * litSurface(isoColour, normal, toEye, open, light, vec2(1.0));
    } else {
      seen.light += seen.clarity * lightOfSegment(ray, grid, segment, cut);
    }
    seen.clarity = 0.0;
    seen.depth = seen.depth < 0.0 ? end : seen.depth;
  }
#ifdef SECOND
  passSecond(ray, other, farAway, layers, seen);
#endif
  return seen;
}
