// A node or particle (sRGB), coloured by its strain.
in vec2 onDisc;
in float shownStrain;

layout(location = 0) out vec4 screen;

uniform vec3 pressed;
uniform vec3 resting;
uniform vec3 pulled;
uniform float opacity;

void main() {
  float away = dot(onDisc, onDisc);
  if (away > 1.0) {
    discard;
  }
  float share = sqrt(min(1.0, abs(shownStrain)));
  vec3 colour = mix(resting, shownStrain < 0.0 ? pressed : pulled, share);
  float strength = opacity * mix(0.45, 1.0, share);
  screen = vec4(colour * mix(1.0, 0.7, away) * strength, strength);
}
