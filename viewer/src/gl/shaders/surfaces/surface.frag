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
// the segment's factors on ambient and specular light
uniform vec2 factors;
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
#ifdef CLIPPED
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform mat4 gridFromPosed;
// from the cube of the camera's projection, and how large that is drawn [pixels]
uniform mat4 sceneFromCube;
uniform vec2 layerSize;

// The cut face in a pixel: told by the pixel alone, so that all triangles in it find the same one.
struct Cap {
  vec3 place;
  // of the plane, toward what is cut away
  vec3 normal;
  float depth;
};

// Where the ray of a pixel comes to what is kept; false where it never does, or begins in it.
bool entersKept(out Cap cap) {
  vec2 pixel = gl_FragCoord.xy / layerSize * 2.0 - 1.0;
  vec4 near = sceneFromCube * vec4(pixel, -1.0, 1.0);
  vec4 far = sceneFromCube * vec4(pixel, 1.0, 1.0);
  vec3 begin = near.xyz / near.w;
  vec3 way = far.xyz / far.w - begin;
  float enter = 0.0;
  float leave = 1.0;
  for (int i = 0; i < CLIP_PLANES; ++i) {
    if (i >= clipCount) {
      break;
    }
    float rise = dot(clipPlanes[i].xyz, way);
    float t = -dot(clipPlanes[i], vec4(begin, 1.0)) / rise;
    if (rise < 0.0 && t > enter) {
      enter = t;
      cap.normal = clipPlanes[i].xyz;
    }
    leave = rise > 0.0 ? min(leave, t) : leave;
  }
  cap.place = begin + enter * way;
  return enter > 0.0 && enter < leave;
}

bool findCap(out Cap cap) {
  if (bare > 0.5 || !entersKept(cap)) {
    return false;
  }
  vec3 behind = (gridFromPosed * vec4(cap.place - 0.01 * cap.normal, 1.0)).xyz;
  if (!insideSegment(behind, 0)) {
    return false;
  }
  vec4 projected = projectionMatrix * viewMatrix * vec4(cap.place, 1.0);
  cap.depth = 0.5 * projected.z / projected.w + 0.5;
  return true;
}

void drawCap(Cap cap) {
  vec3 toEye = normalize(eye.xyz - eye.w * cap.place);
  vec2 light = lightAt((gridFromScene * vec4(cap.place, 1.0)).xyz, mat3(gridFromScene) * cap.normal * spacing);
  picture = vec4(litSurface(colour, cap.normal, toEye, 1.0, light, factors) * opacity, opacity);
  gl_FragDepth = cap.depth;
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
#ifdef TRANSLUCENT
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float before = peeled > 0.5 ? texelFetch(depthBefore, pixel, 0).r + sameDepth : -1.0;
  float behind = texelFetch(depthOpaque, pixel, 0).r;
#else
  const float before = -1.0;
  const float behind = 2.0;
#endif
#ifdef CLIPPED
  Cap cap;
  // it lies before all of the surface that is kept
  if (findCap(cap) && cap.depth > before && cap.depth < behind) {
    drawCap(cap);
    return;
  }
  gl_FragDepth = gl_FragCoord.z;
#endif
  if (gl_FragCoord.z <= before || gl_FragCoord.z >= behind) {
    discard;
  }
  vec3 toEye = normalize(eye.xyz - eye.w * posed);
  vec3 normal = unit(posedNormal, toEye);
  float open = bare > 0.5 ? 1.0 : nearOpenness(grid, unit(gridNormal, vec3(0.0, 0.0, 1.0)), 0);
  normal = dot(normal, toEye) < 0.0 ? -normal : normal;
  vec2 light = lightAt((gridFromScene * vec4(posed, 1.0)).xyz, mat3(gridFromScene) * normal * spacing);
  picture = vec4(litSurface(colour, normal, toEye, open, light, factors) * opacity, opacity);
}
