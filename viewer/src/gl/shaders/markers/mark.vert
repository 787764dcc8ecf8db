// A piece of a mark, a line or a point, as a strip that faces the viewer; scene [mm], sizes in CSS pixels.
in vec3 position;
in vec3 start;
in vec3 end;

uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
// height of what is seen [pixels]
uniform float height;
// half the width of a line with its halo, and half the square of a point
uniform vec2 reach;
// what lies on a surface is drawn this far before it
uniform float toward;

// from a line's middle, or from a point [pixels]
out vec2 place;
// half the width of the piece
flat out float halfSize;
// 1 for a point
flat out float isPoint;

bool parallel() {
  return projectionMatrix[3][3] > 0.5;
}

// In an orthographic view the eye is straight ahead.
vec3 toEye(vec3 inView) {
  return parallel() ? vec3(0.0, 0.0, 1.0) : -inView / max(length(inView), 1e-6);
}

// Size of a pixel at a place of the view [mm].
float pixelAt(vec3 inView) {
  return 2.0 / (projectionMatrix[1][1] * height) * (parallel() ? 1.0 : max(-inView.z, 1e-3));
}

vec3 nearer(vec3 inView) {
  return inView + toward * pixelAt(inView) * toEye(inView);
}

void main() {
  vec3 from = nearer((viewMatrix * vec4(start, 1.0)).xyz);
  vec3 to = nearer((viewMatrix * vec4(end, 1.0)).xyz);
  isPoint = start == end ? 1.0 : 0.0;
  halfSize = isPoint > 0.5 ? reach.y : reach.x;
  vec3 at = mix(from, to, position.x);
  vec3 along = vec3(1.0, 0.0, 0.0);
  vec3 across = vec3(0.0, 1.0, 0.0);
  place = halfSize * vec2(2.0 * position.x - 1.0, position.y);
  if (isPoint < 0.5) {
    vec3 sideways = cross(toEye(at), to - from);
    across = sideways / max(length(sideways), 1e-9);
    along = vec3(0.0);
    place.x = 0.0;
  }
  at += pixelAt(at) * (along * place.x + across * place.y);
  gl_Position = projectionMatrix * vec4(at, 1.0);
}
