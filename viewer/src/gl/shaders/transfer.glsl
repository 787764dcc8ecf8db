// The transfer function: colour and extinction of a value, and their mean over all values between two.

uniform sampler2D transferTexture;
// running integrals of the same row over its coordinate: colour times extinction, extinction
uniform sampler2D integralTexture;
// biased value -> place in the row, 0..1
uniform vec2 transferScale;
// gradient of a full boundary [value per mm], share that flat tissue keeps
uniform vec2 edge;
// factor on all extinction
uniform float density;

// The transfer function at a place of its row.
vec4 tissueAt(float place) {
  float texels = float(textureSize(transferTexture, 0).x);
  return texture(transferTexture, vec2((clamp(place, 0.0, 1.0) * (texels - 1.0) + 0.5) / texels, 0.5));
}

vec4 integralTo(float place) {
  int last = textureSize(integralTexture, 0).x - 1;
  float inside = clamp(place, 0.0, 1.0);
  float texel = inside * float(last);
  int first = min(int(texel), last - 1);
  vec4 low = texelFetch(integralTexture, ivec2(first, 0), 0);
  vec4 high = texelFetch(integralTexture, ivec2(first + 1, 0), 0);
  vec4 integral = low + (high - low) * (texel - float(first));
  vec4 outer = tissueAt(inside);
  return integral + (place - inside) * vec4(outer.rgb * outer.a, outer.a);
}

// Mean of the transfer function over all values between two: colour, and extinction [1/mm].
vec4 tissueBetween(float front, float back) {
  float a = front * transferScale.x + transferScale.y;
  float b = back * transferScale.x + transferScale.y;
  float texels = float(textureSize(transferTexture, 0).x);
  if (abs(b - a) * texels < 2.0) {
    return tissueAt(0.5 * (a + b));
  }
  vec4 mean = (integralTo(b) - integralTo(a)) / (b - a);
  return vec4(mean.rgb / max(mean.a, 1e-9), mean.a);
}
