// What is cut away: all that lies before any of some planes (core/view/clip.ts).

#define CLIP_PLANES 12

// normal toward what is cut away, and a number: their sum over a point is its way before the plane [mm]
uniform vec4 clipPlanes[CLIP_PLANES];
uniform int clipCount;

bool isCutAway(vec3 point) {
  for (int i = 0; i < CLIP_PLANES; ++i) {
    if (i >= clipCount) {
      break;
    }
    if (dot(clipPlanes[i], vec4(point, 1.0)) > 0.0) {
      return true;
    }
  }
  return false;
}
