// How deep what is seen lies, by the depth buffer of a drawn picture (0 to 1): of haze that never becomes opaque, where
// the engine says, or the middle of what is shown; of the ground, beyond all.

layout(location = 0) out vec4 seen;

uniform sampler2D picture;
uniform sampler2D pictureDepth;
uniform float hazeDepth;
// of the engine's picture, see `engine.frag`
uniform highp usampler2D engineDepth;
uniform vec2 depthSpan;
uniform vec2 ofEyes;
uniform vec2 used;
uniform vec2 fit;
// near and far plane [mm], and 1 where the view is orthographic
uniform vec2 drawnNearFar;
uniform float drawnParallel;

const float ground = 2.0;
// so little of it is ground
const float leastOpacity = 0.01;

float windowDepth(float viewDepth) {
  float near = drawnNearFar.x;
  float far = drawnNearFar.y;
  float share = clamp((viewDepth - near) / (far - near), 0.0, 1.0);
  return drawnParallel > 0.5 ? share : share * far / viewDepth;
}

float hazeDepthAt(vec2 texel) {
  vec2 place = 0.5 + fit * (texel / used - 0.5) * vec2(1.0, -1.0);
  vec2 size = vec2(textureSize(engineDepth, 0)) / vec2(1.0, ofEyes.y);
  ivec2 pixel = ivec2(clamp(place * size, vec2(0.0), size - 1.0) + vec2(0.0, ofEyes.x * size.y));
  uint stored = texelFetch(engineDepth, pixel, 0).r;
  bool isTold = stored > 32767u && stored < 65535u;
  return isTold ? windowDepth(mix(depthSpan.x, depthSpan.y, float(stored - 32768u) / 32766.0)) : hazeDepth;
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(pictureDepth, texel, 0).r;
  bool isGround = texelFetch(picture, texel, 0).a < leastOpacity;
  seen = vec4(depth < 1.0 ? depth : isGround ? ground : hazeDepthAt(gl_FragCoord.xy), 0.0, 0.0, 1.0);
}
