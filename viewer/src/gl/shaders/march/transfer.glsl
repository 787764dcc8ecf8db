// The transfer function: colour and extinction of a value, and their mean over all values between two.

uniform sampler2D transferTexture;
// running integrals of the same row over its coordinate: colour times extinction, extinction
uniform sampler2D integralTexture;
// biased value -> place in the row, 0..1
uniform vec2 transferScale;
// the same that is integrated, at the row's ends
uniform vec4 transferEnds[2];
// gradient of a full boundary [value per mm], share that flat tissue keeps
uniform vec2 edge;
// factor on all extinction
uniform float density;

// The transfer function at a place of its row.
vec4 tissueAt(float place) {
  float texels = float(textureSize(transferTexture, 0).x);
  return texture(transferTexture, vec2((clamp(place, 0.0, 1.0) * (texels - 1.0) + 0.5) / texels, 0.5));
}

// The running integral up to a place; outside of the row the function stays as at its ends.
vec4 integralTo(float place) {
  int last = textureSize(integralTexture, 0).x - 1;
  float texel = clamp(place, 0.0, 1.0) * float(last);
  int first = min(int(texel), last - 1);
  vec4 low = texelFetch(integralTexture, ivec2(first, 0), 0);
  vec4 high = texelFetch(integralTexture, ivec2(first + 1, 0), 0);
  vec4 integral = low + (high - low) * (texel - float(first));
  return integral + min(place, 0.0) * transferEnds[0] + max(place - 1.0, 0.0) * transferEnds[1];
}

// Mean of the transfer function over all values between two: colour, and extinction [1/mm]. Over less than two texels
// of the row a difference of sums would be mostly their rounding.
vec4 tissueBetween(float front, float back) {
  float texel = 1.0 / float(textureSize(integralTexture, 0).x);
  float middle = 0.5 * (front + back) * transferScale.x + transferScale.y;
  float reach = max(0.5 * abs((back - front) * transferScale.x), texel);
  vec4 mean = (integralTo(middle + reach) - integralTo(middle - reach)) / (2.0 * reach);
  return vec4(mean.rgb / max(mean.a, 1e-9), mean.a);
}
