// A picture of the engine into the cached picture (premultiplied linear colour) and its depth.

layout(location = 0) out vec4 picture;

// linear; or, where brightest is not 0, of twice as many rows: sRGB of shares of it, and below that opacity. Of two
// eyes one picture below the other
uniform sampler2D engineColour;
uniform float brightest;
// of the picture [pixels], and where what of it has come begins, from its upper left corner, and its size
uniform vec2 engineSize;
uniform vec2 partFirst;
uniform vec2 partSize;
// the eye, and how many there are
uniform vec2 ofEyes;
// part of the target in use [pixels], and how much more of the view it shows than the picture, along each axis
uniform vec2 used;
uniform vec2 fit;
// 0 to 32766 from the nearest depth to the farthest; from 32768 on that of haze, which hides no marker
uniform highp usampler2D engineDepth;
// [mm]
uniform vec2 depthSpan;

vec3 linearFromSrgb(vec3 colour) {
  return mix(pow((colour + 0.055) / 1.055, vec3(2.4)), colour / 12.92, step(colour, vec3(0.04045)));
}

vec4 colourAt(ivec2 pixel) {
  pixel.y += int(ofEyes.x * partSize.y);
  vec4 stored = texelFetch(engineColour, pixel, 0);
  if (brightest == 0.0) {
    return stored;
  }
  float opacity = texelFetch(engineColour, pixel + ivec2(0, int(ofEyes.y * partSize.y)), 0).g;
  // what packing leaves where nothing is does not shine
  return opacity < 0.5 / 255.0 ? vec4(0.0) : vec4(brightest * linearFromSrgb(stored.rgb), opacity);
}

// at a place in what has come, 0 to 1 from its upper left corner
float viewDepthAt(vec2 place) {
  vec2 size = vec2(textureSize(engineDepth, 0)) / vec2(1.0, ofEyes.y);
  uint stored = texelFetch(engineDepth, ivec2(place * size + vec2(0.0, ofEyes.x * size.y)), 0).r;
  return stored > 32767u ? farAway : mix(depthSpan.x, depthSpan.y, float(stored) / 32766.0);
}

void main() {
  // its rows begin at the upper edge
  vec2 place = 0.5 + fit * (gl_FragCoord.xy / used - 0.5) * vec2(1.0, -1.0);
  vec2 pixel = place * engineSize - partFirst;
  place = pixel / partSize;
  bool isInside = all(greaterThanEqual(place, vec2(0.0))) && all(lessThan(place, vec2(1.0)));
  picture = isInside ? colourAt(ivec2(pixel)) : vec4(0.0);
  float depth = isInside ? viewDepthAt(place) : farAway;
  gl_FragDepth = depth >= farAway ? 1.0 : windowDepth(depth);
}
