// A picture of the engine into the cached picture (premultiplied linear colour) and its depth.

layout(location = 0) out vec4 picture;

uniform sampler2D engineColour;
// 0 to 65534 from the nearest depth to the farthest, 65535 where nothing is
uniform highp usampler2D engineDepth;
// [mm]
uniform vec2 depthSpan;

float viewDepthAt(ivec2 pixel) {
  uint stored = texelFetch(engineDepth, pixel, 0).r;
  return stored == 65535u ? farAway : mix(depthSpan.x, depthSpan.y, float(stored) / 65534.0);
}

void main() {
  ivec2 size = textureSize(engineColour, 0);
  // its rows begin at the upper edge
  ivec2 pixel = ivec2(gl_FragCoord.x, size.y - 1 - int(gl_FragCoord.y));
  picture = texelFetch(engineColour, pixel, 0);
  float depth = viewDepthAt(pixel);
  gl_FragDepth = depth >= farAway ? 1.0 : windowDepth(depth);
}
