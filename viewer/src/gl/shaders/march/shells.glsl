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

// What is left or come into from one place to another: a bit for each range, and one each for the label before and now.
uvec2 crossedBetween(Shells before, Shells now) {
  uvec2 crossed = uvec2(before.ranges ^ now.ranges, 0u);
  if (before.label != now.label) {
    crossed.y = (before.label > 0 ? 1u : 0u) | (now.label > 0 ? 2u : 0u);
  }
  return crossed;
}

// Takes the first of them out.
int takeCrossed(inout uvec2 crossed, Shells before, Shells now) {
  if (crossed.x != 0u) {
    // a power of two is told by its exponent
    uint lowest = crossed.x & (~crossed.x + 1u);
    crossed.x ^= lowest;
    return int(floatBitsToUint(float(lowest)) >> 23u) - 126;
  }
  bool left = (crossed.y & 1u) != 0u;
  crossed.y = left ? crossed.y & 2u : 0u;
  return RANGES + (left ? before.label : now.label);
}

// Lets the light of bodies in that a ray leaves or comes into between two samples, up to where it is in `now`, or that
// are cut open where it begins; true where there are any.
bool passShells(
  Ray ray, vec2 interval, Shells now, bool cut, inout Shells shells, inout Layers layers, inout Seen seen
) {
  if (shells.left == 0 || shells == now) {
    return false;
  }
  Shells before = shells;
  shells = now;
  uvec2 crossed = crossedBetween(before, now);
  for (; crossed != uvec2(0u) && shells.left > 0; --shells.left) {
    int segment = takeCrossed(crossed, before, now);
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
  }
  return true;
}

// The bodies that a ray begins in, cut open there by a clip plane or by the end of the scan.
Shells enterShells(Ray ray, inout Layers layers, inout Seen seen) {
  Shells shells = Shells(0u, 0, ray.span.x < ray.span.y ? mostShells : 0);
  if (shells.left > 0) {
    vec3 grid = ray.origin + ray.inGrid * ray.span.x;
    passShells(ray, vec2(ray.span.x), shellsAt(grid, biasedAt(grid), shells.left), true, shells, layers, seen);
  }
  return shells;
}
#endif
