// How deep what is seen lies, by the depth buffer of a drawn picture (0 to 1): of haze that never becomes opaque, the
// middle of what is shown; of the ground, beyond all.

layout(location = 0) out vec4 seen;

uniform sampler2D picture;
uniform sampler2D pictureDepth;
uniform float hazeDepth;

const float ground = 2.0;
// so little of it is ground
const float leastOpacity = 0.01;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(pictureDepth, texel, 0).r;
  bool isGround = texelFetch(picture, texel, 0).a < leastOpacity;
  seen = vec4(depth < 1.0 ? depth : isGround ? ground : hazeDepth, 0.0, 0.0, 1.0);
}
