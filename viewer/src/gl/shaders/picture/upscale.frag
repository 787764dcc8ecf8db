// A picture that is put together already (sRGB), enlarged to its pane, with the depth of the cached picture that it is
// of.

layout(location = 0) out vec4 screen;

uniform sampler2D small;
uniform sampler2D pictureDepth;
// part of the depth that is in use [texels]
uniform vec2 used;
// lower left corner and size of the pane on the screen [pixels]
uniform vec2 paneCorner;
uniform vec2 paneSize;

void main() {
  vec2 place = (gl_FragCoord.xy - paneCorner) / paneSize;
  screen = texture(small, place);
  gl_FragDepth = texelFetch(pictureDepth, ivec2(place * used), 0).r;
}
