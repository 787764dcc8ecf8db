// A marker's colour (sRGB): soft light from the viewer's left, brighter toward its outline.
in vec3 normalInView;
in vec3 positionInView;

layout(location = 0) out vec4 screen;

uniform vec3 colour;
uniform float opacity;

void main() {
  vec3 normal = normalize(normalInView);
  vec3 toEye = normalize(-positionInView);
  float key = max(dot(normal, normalize(vec3(-0.4, 0.6, 0.7))), 0.0);
  float rim = pow(1.0 - abs(dot(normal, toEye)), 2.0);
  vec3 lit = colour * (0.5 + 0.5 * key) + 0.25 * rim;
  screen = vec4(lit * opacity, opacity);
}
