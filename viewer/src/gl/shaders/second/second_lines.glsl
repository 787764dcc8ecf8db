// Lines of equal value of the second scan in a slice (core/second/isolines.ts). Value and gradient are interpolated
// here: textures are filtered with 8 bits, which shows as steps along a line.

#ifdef SECOND
const int mostLines = 8;
// colour (sRGB), and the biased value
uniform vec4 secondLines[mostLines];
uniform int secondLineCount;

// Gradient of the biased value [per texel], and the value, between the texels around a place.
vec4 secondBetween(vec3 share) {
  vec3 size = vec3(textureSize(secondTexture, 0));
  vec3 at = clamp((share * secondTextureScale + secondTextureOffset) * size - 0.5, vec3(0.0), size - 1.0);
  vec3 low = min(floor(at), max(size - 2.0, 0.0));
  vec3 f = at - low;
  ivec3 a = ivec3(low);
  ivec3 b = min(a + 1, ivec3(size) - 1);
  // corners of the cell: y and z as named, x in the components
  vec2 c00 = vec2(secondTexel(a), secondTexel(ivec3(b.x, a.yz)));
  vec2 c10 = vec2(secondTexel(ivec3(a.x, b.y, a.z)), secondTexel(ivec3(b.xy, a.z)));
  vec2 c01 = vec2(secondTexel(ivec3(a.xy, b.z)), secondTexel(ivec3(b.x, a.y, b.z)));
  vec2 c11 = vec2(secondTexel(ivec3(a.x, b.yz)), secondTexel(b));
  vec2 front = mix(c00, c10, f.y);
  vec2 back = mix(c01, c11, f.y);
  vec2 both = mix(front, back, f.z);
  vec2 across = mix(c10 - c00, c11 - c01, f.z);
  vec2 deep = back - front;
  return vec4(both.y - both.x, mix(across.x, across.y, f.x), mix(deep.x, deep.y, f.x), mix(both.x, both.y, f.x));
}

// `right`, `up`: from pixel to pixel in the first scan's grid; `width` of a line [pixels].
vec3 withLines(vec3 colour, vec3 grid, vec3 right, vec3 up, float width) {
  vec3 place = placeOnSecond(grid);
  if (secondLineCount == 0 || !isOnSecond(place)) {
    return colour;
  }
  vec4 there = secondBetween(place);
  vec3 texels = vec3(textureSize(secondTexture, 0)) * secondTextureScale;
  mat3 turn = mat3(secondFromGrid);
  float perPixel = length(vec2(dot(there.xyz, texels * (turn * right)), dot(there.xyz, texels * (turn * up))));
  for (int i = 0; i < mostLines; ++i) {
    if (i >= secondLineCount) {
      break;
    }
    // how far away the line is [pixels], as if the value rose evenly
    float away = abs(there.w - secondLines[i].a) / max(perPixel, 1e-6);
    colour = mix(colour, secondLines[i].rgb, clamp(0.5 * width + 0.5 - away, 0.0, 1.0));
  }
  return colour;
}
#endif
