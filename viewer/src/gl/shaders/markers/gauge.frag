// The force as a ring around the probe: a full turn is the largest force. An arrow that
// points at the viewer cannot be read, the ring can.
in vec2 place;

layout(location = 0) out vec4 screen;

uniform vec3 colour;
uniform float share;
// size of a pixel [share of the reach]
uniform float pixel;

void main() {
  float radius = length(place);
  float band = abs(radius - 0.8) - 0.09;
  float inside = 1.0 - smoothstep(0.0, pixel, band);
  // clockwise from the top
  float turn = fract(atan(place.x, place.y) / 6.2831853);
  float filled = 1.0 - smoothstep(share - 0.004, share + 0.004, turn);
  float opacity = inside * mix(0.28, 0.95, filled);
  screen = vec4(mix(vec3(0.05, 0.06, 0.08), colour, filled) * opacity, opacity);
}
