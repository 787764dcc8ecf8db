// Two pictures (sRGB), one for each eye, as one for glasses of red and cyan: the colours that come nearest
// through the glasses to those of both pictures, by least squares in linear light; each eye's share is
// clipped before both are added. Where a picture is transparent the glass before it sees black.
// Source: Dubois, "Conversion of a stereo pair to anaglyph with the least-squares projection method" (2009).

layout(location = 0) out vec4 screen;

uniform sampler2D leftEye;
uniform sampler2D rightEye;
// lower left of the pane on the screen [pixels]
uniform vec2 corner;

// columns: what red, green and blue of an eye's picture become
const mat3 fromLeft = mat3(0.437, -0.062, -0.048, 0.449, -0.062, -0.050, 0.164, -0.024, -0.017);
const mat3 fromRight = mat3(-0.011, 0.377, -0.026, -0.032, 0.761, -0.093, -0.007, 0.009, 1.234);

vec3 linearFromSrgb(vec3 c) {
  return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, step(c, vec3(0.04045)));
}

vec3 srgbFromLinear(vec3 c) {
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, step(c, vec3(0.0031308)));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy - corner);
  vec4 leftSeen = texelFetch(leftEye, pixel, 0);
  vec4 rightSeen = texelFetch(rightEye, pixel, 0);
  vec3 left = linearFromSrgb(leftSeen.rgb) * leftSeen.a;
  vec3 right = linearFromSrgb(rightSeen.rgb) * rightSeen.a;
  vec3 mixed = clamp(fromLeft * left, 0.0, 1.0) + clamp(fromRight * right, 0.0, 1.0);
  float opacity = max(leftSeen.a, rightSeen.a);
  screen = vec4(srgbFromLinear(min(mixed / max(opacity, 1e-4), 1.0)), opacity);
}
