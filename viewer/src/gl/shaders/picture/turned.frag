// A drawn picture as it is seen from a view nearby: each ray of that view is followed through the drawn picture's depth
// until it meets what was seen there. Where it passes behind an edge and meets nothing more, the farther side of the
// edge stands in: what lies behind goes on.
//
// Sources: McMillan and Bishop, "Plenoptic modeling: an image-based rendering system", SIGGRAPH (1995); Mark, McMillan
// and Bishop, "Post-rendering 3D warping", I3D (1997). Those take pixels to where they are seen now; rays instead leave
// no gaps (Policarpo, Oliveira and Comba, "Real-time relief mapping on arbitrary polygonal surfaces", I3D, 2005).

layout(location = 0) out vec4 turned;

// the drawn picture: premultiplied linear colour, its depth, and the depth of what is seen (`seen_depth.frag`)
uniform sampler2D picture;
uniform sampler2D pictureDepth;
uniform sampler2D seenDepth;
// part of its texture that is in use, and its size [texels]
uniform vec2 share;
uniform vec2 used;
// near and far plane of its view [mm], and 1 where that is orthographic
uniform vec2 drawnNearFar;
uniform float drawnParallel;
// between them lies what is seen in it [normalised device coordinates]
uniform vec2 drawnReach;
// size of this picture [pixels]
uniform vec2 size;
// from normalised device coordinates of this view to clip coordinates of the drawn one
uniform mat4 drawnFromTurned;
// along each ray
uniform int steps;
// a surface is taken to reach so far behind what is seen of it [mm]
uniform float thickness;

const int mostEdges = 3;
const int halvings = 5;
// no place on a ray
const float nowhere = 2.0;

// a ray of this view in the drawn one, in clip coordinates: at depth 0 of this view, and how it goes on
vec4 origin;
vec4 along;

float viewDepth(float window) {
  float near = drawnNearFar.x;
  float far = drawnNearFar.y;
  return drawnParallel > 0.5 ? mix(near, far, window) : near * far / (far - window * (far - near));
}

// where the ray is in the drawn picture, 0 to 1, at a depth of this view; and how deep there
vec3 drawnAt(float z) {
  vec4 clip = origin + z * along;
  return 0.5 + 0.5 * clip.xyz / clip.w;
}

// at which depth of this view the ray is so deep in the drawn one; all in normalised device coordinates
float placeAt(float drawn) {
  return (drawn * origin.w - origin.z) / (along.z - drawn * along.w);
}

// beyond the picture its edge goes on
ivec2 texelAt(vec2 place) {
  return ivec2(clamp(place * used, vec2(0.0), used - 1.0));
}

float seenAt(vec2 place) {
  return texelFetch(seenDepth, texelAt(place), 0).r;
}

bool isBehind(float z) {
  vec3 drawn = drawnAt(z);
  return drawn.z >= seenAt(drawn.xy);
}

vec4 colourAt(vec2 place) {
  // stay half a texel inside: beyond lies an older picture
  vec2 texel = share / used;
  return texture(picture, clamp(place * share, 0.5 * texel, share - 0.5 * texel));
}

// What goes on behind an edge: the mean of what is as deep around there, so that it makes no stripes.
vec4 around(vec2 place) {
  float depth = seenAt(place);
  float deep = viewDepth(depth);
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  // a loop that no ray needs costs nothing, a branch does where the CPU draws
  for (int i = 0; i < 15; ++i) {
    vec2 near = place + 1.5 * vec2(i % 3 - 1, i / 3 - 2) / size;
    float seen = seenAt(near);
    float counts = seen <= 1.0 && abs(viewDepth(seen) - deep) <= thickness ? 1.0 : 0.0;
    sum += counts * colourAt(near);
    weight += counts;
  }
  return sum / weight;
}

void main() {
  vec2 pixel = gl_FragCoord.xy / size * 2.0 - 1.0;
  origin = drawnFromTurned * vec4(pixel, 0.0, 1.0);
  along = drawnFromTurned[2];
  float begin = placeAt(drawnReach.x);
  float stride = (placeAt(drawnReach.y) - begin) / float(steps);

  float met = nowhere;
  // before an edge that the ray passed behind, and how deep it is there
  float beside = nowhere;
  float deepest = -1.0;
  bool wasBehind = false;
  int i = 0;
  for (int edge = 0; edge < mostEdges && met == nowhere && i < steps; ++edge) {
    bool entered = false;
    while (i < steps && !entered) {
      ++i;
      bool behind = isBehind(begin + float(i) * stride);
      entered = behind && !wasBehind;
      wasBehind = behind;
    }
    float after = begin + float(i) * stride;
    float before = after - stride;
    for (int j = 0; entered && j < halvings; ++j) {
      float middle = 0.5 * (before + after);
      bool behind = isBehind(middle);
      after = behind ? middle : after;
      before = behind ? before : middle;
    }
    vec3 drawn = drawnAt(after);
    float seen = seenAt(drawn.xy);
    float farther = seenAt(drawnAt(before).xy);
    bool isMet = entered && viewDepth(drawn.z) - viewDepth(seen) <= thickness;
    bool isPassed = entered && !isMet && farther <= 1.0 && farther > deepest;
    met = isMet ? after : met;
    beside = isPassed ? before : beside;
    deepest = isPassed ? farther : deepest;
  }

  bool isFilled = met == nowhere && beside != nowhere;
  met = isFilled ? beside : met;
  vec2 at = drawnAt(met).xy;
  turned = met == nowhere ? vec4(0.0) : colourAt(at);
  for (int j = 0; isFilled && j < 1; ++j) {
    turned = around(at);
  }
  // haze hides no marker
  bool hides = met != nowhere && texelFetch(pictureDepth, texelAt(at), 0).r < 1.0;
  gl_FragDepth = hides ? 0.5 + 0.5 * met : 1.0;
}
