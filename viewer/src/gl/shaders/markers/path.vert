// A piece of the probe's way: a strip of constant width that faces the viewer; scene [mm].
in vec3 position;
in vec3 start;
in vec3 end;
in vec2 fresh;

uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
// size of a CSS pixel at the probe [mm]
uniform float pixel;
// [pixels]
uniform float halfWidth;
// a line on the surface is drawn this far before it [pixels]
uniform float toward;

out float freshness;
out float across;

// In an orthographic view the eye is straight ahead.
vec3 toEye(vec3 inView) {
  return projectionMatrix[3][3] > 0.5 ? vec3(0.0, 0.0, 1.0) : -inView / max(length(inView), 1e-6);
}

vec3 nearer(vec3 inView) {
  return inView + toward * pixel * toEye(inView);
}

void main() {
  vec3 from = nearer((viewMatrix * vec4(start, 1.0)).xyz);
  vec3 to = nearer((viewMatrix * vec4(end, 1.0)).xyz);
  vec3 along = to - from;
  vec3 sideways = cross(toEye(to), along);
  float size = length(sideways);
  sideways = size > 1e-9 ? sideways / size : vec3(0.0, 1.0, 0.0);

  vec3 place = mix(from, to, position.x) + sideways * position.y * halfWidth * pixel;
  freshness = mix(fresh.x, fresh.y, position.x);
  across = position.y;
  gl_Position = projectionMatrix * vec4(place, 1.0);
}
