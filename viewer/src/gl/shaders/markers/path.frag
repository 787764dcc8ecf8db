// The probe's way (sRGB): soft at its rims, fading with age.
in float freshness;
in float across;

layout(location = 0) out vec4 screen;

uniform vec3 colour;
uniform float opacity;

void main() {
  float soft = 1.0 - smoothstep(0.5, 1.0, abs(across));
  float strength = opacity * soft * pow(freshness, 1.5);
  screen = vec4(colour * strength, strength);
}
