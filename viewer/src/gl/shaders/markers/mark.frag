// A piece of a mark (sRGB): a line, or a ring around a point, with a dark halo.
in vec2 place;
flat in float halfSize;
flat in float isPoint;

layout(location = 0) out vec4 screen;

uniform vec3 colour;
uniform float opacity;
// half the width of a line, and the radius of a point's ring [pixels]
uniform float halfLine;
uniform float ring;

void main() {
  float away = length(place);
  float toLine = isPoint > 0.5 ? abs(away - ring) : away;
  float line = 1.0 - smoothstep(halfLine - 0.5, halfLine + 0.5, toLine);
  float halo = 0.6 * (1.0 - smoothstep(halfSize - 1.0, halfSize, away));
  float strength = max(line, halo);
  screen = vec4(colour * line, strength) * opacity;
}
