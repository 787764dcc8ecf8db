// Front-to-back ray casting of the scan into the cached picture (premultiplied linear
// colour) and its depth: where the ray became more opaque than clear.
//
// Positions run in grid coordinates, lengths along the ray in mm. Tissue is post-classified
// and post-shaded; its opacity is corrected for the step. Visible segments are surfaces,
// found to 1/32 of a step; where tissue becomes opaque, steps are quartered. Surfaces of
// triangles stand in the ray at their depth (surfaces.glsl). Bricks that hold
// nothing drawn are leapt over in whole steps, so that skipping changes no pixel.
// Source: Engel et al., "Real-Time Volume Graphics" (2006), ch. 4, 8; Levoy, "Display of
// surfaces from volume data", IEEE CG&A 8 (1988) for the weight of boundaries.

layout(location = 0) out vec4 picture;

uniform vec2 pictureSize;
// shift within the pixel and of the noise, for averaging several pictures
uniform vec3 shift;
uniform vec3 eye;
// axes of the view along the grid's axes, per mm; `across` and `upward` reach half the picture
uniform vec3 forward;
uniform vec3 across;
uniform vec3 upward;
// length of a step [mm]; 1 where the start is jittered
uniform float stepLength;
uniform float jitter;

uniform sampler2D transferTexture;
// biased value -> texture coordinate
uniform vec2 transferScale;
// gradient of a full boundary [value per mm], share that flat tissue keeps
uniform vec2 edge;

uniform sampler3D brickTexture;
uniform vec3 brickScale;
uniform vec3 brickOffset;

const float clearEnough = 0.012;
const int refinements = 5;
// opacity of a whole step from which on it is quartered, and for how many quarters
const float opaqueStep = 0.12;
const int quarters = 4;

// Where the ray is inside a box [grid]; `face` gets the one through which it enters.
vec2 throughBox(vec3 low, vec3 high, vec3 direction, out vec3 face) {
  vec3 inverse = 1.0 / (mix(vec3(1.0), sign(direction), step(1e-12, abs(direction))) * max(abs(direction), 1e-12));
  vec3 a = (low - eye) * inverse;
  vec3 b = (high - eye) * inverse;
  vec3 near = min(a, b);
  vec3 far = max(a, b);
  float enter = max(max(near.x, near.y), near.z);
  face = -sign(direction) * step(vec3(enter), near);
  return vec2(max(enter, 0.0), min(min(far.x, far.y), far.z));
}

// Where the ray is among matter that stands beside its voxels.
vec2 throughDisplaced(vec3 direction) {
  vec3 face;
  vec2 span = vec2(farAway);
#ifdef DISPLACED
  if (displacedScale.x > 0.0) {
    vec3 low = -displacedOffset / displacedScale;
    span = throughBox(low, low + 1.0 / displacedScale, direction, face);
  }
#endif
  return span;
}

// Length that can be leapt over from here [mm]; 0 in a filled brick. Bricks tell of voxels, and
// nothing of what stands beside them: there nothing is leapt over.
float emptyAhead(vec3 grid, float t, vec2 displaced, vec3 direction) {
#ifdef DISPLACED
  if (displaced.x <= t && t < displaced.y) {
    return 0.0;
  }
#endif
  vec3 place = grid * brickScale + brickOffset;
  vec3 brick = floor(place);
  float reach = floor(texelFetch(brickTexture, ivec3(brick), 0).r * 255.0 + 0.5);
  if (reach == 0.0) {
    return 0.0;
  }
  vec3 speed = direction * brickScale;
  vec3 ahead = mix(place - brick + (reach - 1.0), brick + reach - place, step(0.0, speed));
  vec3 lengths = ahead / max(abs(speed), 1e-9);
  float leap = min(min(lengths.x, lengths.y), lengths.z);
#ifdef DISPLACED
  leap = t < displaced.x ? min(leap, displaced.x - t) : leap;
#endif
  return leap;
}

// Where between two samples the ray enters a segment, and which: where segments lie in one
// another it is the outer one, however steep the step between.
float refinedEntry(vec3 direction, float before, float inside, inout int segment) {
  for (int i = 0; i < refinements; ++i) {
    float middle = 0.5 * (before + inside);
    vec3 grid = eye + direction * middle;
    int here = segmentAt(grid, biasedAt(grid));
    if (here > 0) {
      inside = middle;
      segment = here;
    } else {
      before = middle;
    }
  }
  return inside;
}

#ifdef LABELS
// Outward normal of a label, from the share of its voxels around the point.
vec3 labelNormal(vec3 grid, int label) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 27; ++i) {
    vec3 offset = vec3(i % 3, (i / 3) % 3, i / 9) - 1.0;
    vec3 place = grid + 1.5 * offset * sampleStep;
    sum -= float(labelAt(place) == label) * offset / spacing;
  }
  return sum;
}
#endif

vec3 surfaceNormal(vec3 grid, int segment) {
#ifdef LABELS
  if (segment > RANGES) {
    return labelNormal(grid, segment - RANGES);
  }
  vec4 bounds = rangeBounds[segment - 1];
  if (bounds.w > 0.5 && editedAround(grid, bounds)) {
    return labelNormal(grid, int(bounds.w));
  }
#endif
  return gradientAt(grid);
}

// Unit vector, turned to the viewer; `instead` where there is no direction.
vec3 facing(vec3 vector, vec3 toEye, vec3 instead) {
  float size = length(vector);
  vec3 unit = size > 1e-9 ? vector / size : instead;
  return dot(unit, toEye) < 0.0 ? -unit : unit;
}

float noise(vec2 pixel) {
  // interleaved gradient noise: neighbours differ much, so the eye averages it away
  // (Jimenez, "Next generation post processing in Call of Duty", SIGGRAPH 2014)
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

void main() {
  // the ray, per mm: along the grid's axes in mm and in voxels
  vec2 place = (gl_FragCoord.xy + shift.xy) / pictureSize * 2.0 - 1.0;
  vec3 toPixel = forward + across * place.x + upward * place.y;
  float stretch = length(toPixel);
  vec3 direction = toPixel / stretch;
  vec3 toEye = -direction;
  vec3 inGrid = direction / spacing;

  vec3 face;
  vec2 span = throughBox(vec3(0.0), dimensions, inGrid, face);
  vec2 displaced = throughDisplaced(inGrid);
  Layers layers = layersOnRay(stretch);
  span.y = min(span.y, layers.end);
  float start = jitter > 0.5 ? noise(gl_FragCoord.xy + 5.588238 * shift.z) : 0.5;
  float t = span.x + start * stepLength;
  vec3 light = vec3(0.0);
  float clarity = 1.0;
  float depth = -1.0;

  int fine = 0;
  for (int i = 0; i < 8192; ++i) {
    if (t >= span.y || clarity <= clearEnough) {
      break;
    }
    vec3 grid = eye + inGrid * t;
    float leap = emptyAhead(grid, t, displaced, inGrid);
    if (leap > 0.0) {
      t += max(1.0, ceil(leap / stepLength)) * stepLength;
      fine = 0;
      continue;
    }

    float value = biasedAt(grid);
    int segment = segmentAt(grid, value);
    if (segment > 0) {
      bool cut = t - stepLength <= span.x;
      t = cut ? span.x : refinedEntry(inGrid, t - stepLength, t, segment);
      grid = eye + inGrid * t;
      passLayers(layers, t, light, clarity, depth);
      vec3 normal = cut ? face : facing(surfaceNormal(grid, segment), toEye, toEye);
      light += clarity * litSurface(segmentColour(segment), normal, toEye, openness(grid, normal, segment));
      clarity = 0.0;
      depth = depth < 0.0 ? t : depth;
      break;
    }

    vec4 tissue = texture(transferTexture, vec2(value * transferScale.x + transferScale.y, 0.5));
    if (segment < 0 || tissue.a <= 0.0) {
      t += stepLength;
      fine = 0;
      continue;
    }

    vec3 gradient = coarseGradientAt(grid);
    float boundary = smoothstep(0.0, edge.x, length(gradient));
    float extinction = tissue.a * mix(edge.y, 1.0, boundary);
    bool opaque = extinction * stepLength > opaqueStep;
    if (opaque && fine == 0) {
      // back to the first quarter of the step that led here
      t = max(span.x, t - 0.75 * stepLength);
      fine = quarters;
      continue;
    }
    fine = opaque ? quarters : max(0, fine - 1);
    float h = fine > 0 ? 0.25 * stepLength : stepLength;
    passLayers(layers, t, light, clarity, depth);
    float opacity = 1.0 - exp(-extinction * h);
    vec3 normal = facing(gradient, toEye, toEye);
    light += clarity * opacity * litTissue(tissue.rgb, normal, toEye, boundary);
    clarity *= 1.0 - opacity;
    depth = depth < 0.0 && clarity < 0.5 ? t : depth;
    t += h;
  }

  if (clarity > clearEnough) {
    passLayers(layers, farAway, light, clarity, depth);
    endAtSurface(layers, light, clarity, depth);
  }

  // what early termination left out would have looked like the rest
  float opacity = clarity <= clearEnough ? 1.0 : 1.0 - clarity;
  picture = vec4(light * (opacity / max(1.0 - clarity, 1e-6)), opacity);
  gl_FragDepth = depth < 0.0 ? 1.0 : windowDepth(depth / stretch);
}
