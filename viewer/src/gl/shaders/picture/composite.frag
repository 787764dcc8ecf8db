// The cached picture over the page's background, with its depth, onto the screen (sRGB).

layout(location = 0) out vec4 screen;

uniform sampler2D picture;
uniform sampler2D pictureDepth;
// part of the cached picture's texture that is in use, and its size [texels]
uniform vec2 share;
uniform vec2 used;
// lower left corner and size of the pane on the screen [pixels]
uniform vec2 paneCorner;
uniform vec2 paneSize;
// the same of the whole picture that the background belongs to
uniform vec2 groundCorner;
uniform vec2 groundSize;
// 1 where there is no background: colours are not multiplied by opacity then
uniform float transparent;
// 1 where highlights are bent instead of clipped
uniform float bend;
uniform vec3 backgroundCentre;
uniform vec3 backgroundEdge;

vec3 srgbFromLinear(vec3 colour) {
  vec3 c = clamp(colour, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, step(c, vec3(0.0031308)));
}

// Bends highlights instead of clipping them; identity below 0.7.
vec3 softened(vec3 colour) {
  vec3 over = max(colour - 0.7, 0.0);
  return min(colour, 0.7) + 0.3 * (1.0 - exp(-over / 0.3));
}

void main() {
  vec2 place = (gl_FragCoord.xy - paneCorner) / paneSize;
  // stay half a texel inside: beyond lies an older picture
  vec2 texel = share / used;
  vec2 at = clamp(place * share, 0.5 * texel, share - 0.5 * texel);
  vec4 drawn = texture(picture, at);
  gl_FragDepth = texture(pictureDepth, at).r;

  vec2 onGround = (gl_FragCoord.xy - groundCorner) / groundSize;
  float away = length((onGround - vec2(0.5, 0.52)) * vec2(1.1, 1.25));
  vec3 background = mix(backgroundCentre, backgroundEdge, smoothstep(0.0, 0.85, away));
  vec3 light = mix(drawn.rgb, softened(drawn.rgb), bend);
  if (transparent > 0.5) {
    screen = vec4(srgbFromLinear(light / max(drawn.a, 1e-4)), drawn.a);
    return;
  }
  vec3 colour = light + (1.0 - drawn.a) * background;

  // less than one step of noise hides the steps of a dark gradient
  float grain = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
  screen = vec4(srgbFromLinear(colour) + grain / 255.0, 1.0);
}
