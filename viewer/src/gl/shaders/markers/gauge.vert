// A square that faces the viewer around a point of the scene; sizes in clip space.
in vec3 position;

uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform vec3 centre;
// half the square's edge [mm]
uniform float reach;

out vec2 place;

void main() {
  place = position.xy;
  vec4 inView = viewMatrix * vec4(centre, 1.0);
  inView.xy += position.xy * reach;
  gl_Position = projectionMatrix * inView;
}
