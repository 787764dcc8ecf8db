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
