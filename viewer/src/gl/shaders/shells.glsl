// Translucent bodies that stand for surfaces which can be seen through: a ray gets their light where it comes into
// one and where it leaves it, as many as there would be layers. They may lie in one another.

#ifdef SURFACES
// so many of them along a ray; 0 where none stands for a surface
uniform int mostShells;

// The bodies that a place lies in, a bit for each range and a label or 0; and how many more are let in.
struct Shells {
  uint ranges;
  int label;
  int left;
};

bool isShell(float opacity) {
  return opacity > 0.0 && opacity < 1.0;
}

Shells shellsAt(vec3 grid, float value, int left) {
  Shells found = Shells(0u, 0, left);
  int label = 0;
#ifdef LABELS
  label = labelAt(grid);
  found.label = label > 0 && isShell(bodyOpacity(RANGES + label)) ? label : 0;
#endif
  for (int i = 0; i < RANGES; ++i) {
    if (i >= rangeCount) {
      break;
    }
    if (isShell(rangeMaterials[i].z) && insideRange(grid, value, label, rangeBounds[i])) {
      found.ranges |= 1u << i;
    }
  }
  return found;
}

bool isIn(Shells shells, int segment) {
  return segment > RANGES ? shells.label == segment - RANGES : (shells.ranges >> (segment - 1) & 1u) == 1u;
}

// The range or label that is left or come into, by its place among all ranges, the label before and the label now; 0 for none.
int crossedAt(int place, Shells before, Shells now) {
  if (place < RANGES) {
    return ((before.ranges ^ now.ranges) >> place & 1u) == 1u ? place + 1 : 0;
  }
  int label = before.label == now.label ? 0 : place == RANGES ? before.label : now.label;
  return label > 0 ? RANGES + label : 0;
}

// Lets the light of bodies in that a ray leaves or comes into between two samples, the later one of a value, or that
// are cut open where it begins; true where there are any.
bool passShells(Ray ray, vec2 interval, float value, bool cut, inout Shells shells, inout Layers layers, inout Seen seen) {
  if (shells.left == 0) {
    return false;
  }
  Shells before = shells;
  shells = shellsAt(ray.origin + ray.inGrid * interval.y, value, before.left);
  if (shells == before) {
    return false;
  }
  for (int place = 0; place < RANGES + 2 && shells.left > 0; ++place) {
    int segment = crossedAt(place, before, shells);
    if (segment == 0) {
      continue;
    }
    vec2 between = interval;
    for (int i = 0; i < refinements && !cut; ++i) {
      float middle = 0.5 * (between.x + between.y);
      vec3 grid = ray.origin + ray.inGrid * middle;
      bool isBefore = isIn(shellsAt(grid, biasedAt(grid), 0), segment) == isIn(before, segment);
      between = isBefore ? vec2(middle, between.y) : vec2(between.x, middle);
    }
    passLayers(layers, between.y, seen.light, seen.clarity, seen.depth);
    float opacity = bodyOpacity(segment);
    seen.light += seen.clarity * opacity * lightOfSegment(ray, ray.origin + ray.inGrid * between.y, segment, cut);
    seen.clarity *= 1.0 - opacity;
    seen.depth = seen.depth < 0.0 && seen.clarity < 0.5 ? between.y : seen.depth;
    shells.left -= 1;
  }
  return true;
}

// The bodies that a ray begins in, cut open there by a clip plane or by the end of the scan.
Shells enterShells(Ray ray, inout Layers layers, inout Seen seen) {
  Shells shells = Shells(0u, 0, ray.span.x < ray.span.y ? mostShells : 0);
  if (shells.left > 0) {
    passShells(ray, vec2(ray.span.x), biasedAt(ray.origin + ray.inGrid * ray.span.x), true, shells, layers, seen);
  }
  return shells;
}
#endif
