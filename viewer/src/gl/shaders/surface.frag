// A segment's surface (premultiplied linear colour): lit as the ray caster lights segments,
// from both sides. Light and normals run in the scene, the sky's share in the grid.
//
// Translucent surfaces are peeled: each drawing keeps the nearest of what lies behind the
// layer before and in front of what is opaque.
// Source: Everitt, "Interactive order-independent transparency", NVIDIA (2001).
in vec3 posed;
in vec3 posedNormal;
in vec3 grid;
in vec3 gridNormal;

layout(location = 0) out vec4 picture;

// of an orthographic view the direction toward it, and 0
uniform vec4 eye;
uniform mat4 gridFromScene;
uniform vec3 colour;
uniform float opacity;
// 1 where lines are drawn: what lies between them does not cover them
uniform float bare;

#ifdef TRANSLUCENT
// 1 where there is a layer before
uniform float peeled;
uniform sampler2D depthBefore;
uniform sampler2D depthOpaque;
// below it two depths are the same
const float sameDepth = 2e-7;
#endif

// what clip planes open is closed: where the scan has the segment, its cut face covers what is behind
#if defined(CLIPPED) && !defined(TRANSLUCENT)
#define CAPPED
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform mat4 gridFromPosed;

// Where the way from a kept point to the eye comes to the first plane, and that plane's normal; false where
// it meets none.
bool meetsPlane(vec3 point, vec3 toEye, out vec3 place, out vec3 face) {
  float first = 1.0;
  for (int i = 0; i < CLIP_PLANES; ++i) {
    if (i >= clipCount) {
      break;
    }
    float rise = dot(clipPlanes[i].xyz, toEye);
    float away = -dot(clipPlanes[i], vec4(point, 1.0)) / max(rise, 1e-9);
    if (rise > 0.0 && away < first) {
      first = away;
      face = clipPlanes[i].xyz;
    }
  }
  place = point + first * toEye;
  return first < 1.0;
}

// The cut face in the way to a point; false where there is none.
bool drawCap(vec3 point) {
  vec3 place;
  vec3 face;
  // in an orthographic view the eye is far away
  if (bare > 0.5 || !meetsPlane(point, eye.w > 0.5 ? eye.xyz - point : 1e5 * eye.xyz, place, face)) {
    return false;
  }
  vec3 within = (gridFromPosed * vec4(place - 0.01 * face, 1.0)).xyz;
  if (!insideSegment(within, 0)) {
    return false;
  }
  vec3 toEye = normalize(eye.xyz - eye.w * place);
  vec2 light = lightAt((gridFromScene * vec4(place, 1.0)).xyz, mat3(gridFromScene) * face * spacing);
  picture = vec4(litSurface(colour, face, toEye, 1.0, light) * opacity, opacity);
  vec4 projected = projectionMatrix * viewMatrix * vec4(place, 1.0);
  gl_FragDepth = 0.5 * projected.z / projected.w + 0.5;
  return true;
}
#endif

vec3 unit(vec3 vector, vec3 instead) {
  float size = length(vector);
  return size > 1e-6 ? vector / size : instead;
}

void main() {
  if (isCutAway(posed)) {
    discard;
  }
#ifdef CAPPED
  if (drawCap(posed)) {
    return;
  }
  gl_FragDepth = gl_FragCoord.z;
#endif
#ifdef TRANSLUCENT
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  bool before = peeled > 0.5 && gl_FragCoord.z <= texelFetch(depthBefore, pixel, 0).r + sameDepth;
  if (before || gl_FragCoord.z >= texelFetch(depthOpaque, pixel, 0).r) {
    discard;
  }
#endif
  vec3 toEye = normalize(eye.xyz - eye.w * posed);
  vec3 normal = unit(posedNormal, toEye);
  float open = bare > 0.5 ? 1.0 : openness(grid, unit(gridNormal, vec3(0.0, 0.0, 1.0)), 0);
  normal = dot(normal, toEye) < 0.0 ? -normal : normal;
  vec2 light = lightAt((gridFromScene * vec4(posed, 1.0)).xyz, mat3(gridFromScene) * normal * spacing);
  picture = vec4(litSurface(colour, normal, toEye, open, light) * opacity, opacity);
}
