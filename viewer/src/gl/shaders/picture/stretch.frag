// A cached picture with its depth in the texels of a finer one, which are drawn over it from then on.

layout(location = 0) out vec4 finer;

uniform sampler2D picture;
uniform sampler2D pictureDepth;
// part of the picture's texture that is in use, and its size [texels]
uniform vec2 share;
uniform vec2 used;
// size of the finer one [texels]
uniform vec2 size;

void main() {
  vec2 place = gl_FragCoord.xy / size;
  // stay half a texel inside: beyond lies an older picture
  vec2 texel = share / used;
  finer = texture(picture, clamp(place * share, 0.5 * texel, share - 0.5 * texel));
  gl_FragDepth = texelFetch(pictureDepth, ivec2(place * used), 0).r;
}
