// A ray through the scan: where it goes, which part of it is looked at, and what on its way is
// empty. Positions run in grid coordinates, lengths along the ray in mm.

uniform vec2 pictureSize;
// shift within the pixel and of the noise, for averaging several pictures
uniform vec3 shift;
uniform vec3 eye;
// axes of the view along the grid's axes, per mm; `across` and `upward` reach half the picture: at 1 mm
// of depth in perspective, anywhere in an orthographic view
uniform vec3 forward;
uniform vec3 across;
uniform vec3 upward;
// length of a step [mm]; 1 where the start is jittered
uniform float stepLength;
uniform float jitter;
// nearest and farthest depth that is looked at [mm]
uniform vec2 slab;

const float clearEnough = 0.012;
// along a ray, whatever it is given
const int mostSamples = 8192;

struct Ray {
  // where it begins [grid]
  vec3 origin;
  // direction along the grid's axes, per mm: in mm, and in voxels
  vec3 direction;
  vec3 inGrid;
  // per mm of depth
  float stretch;
  // from where to where it is followed [mm], and the normal of the face through which it enters
  vec2 span;
  vec3 face;
#ifdef SECOND
  // the same of the second scan, which reaches beyond the first
  vec2 other;
  vec3 otherFace;
#endif
  // where it is in displaced tissue [mm]
  vec2 displaced;
  // share of a step before the first sample
  float start;
};

// What has been seen along a ray: light, share that still passes, and the length at which the ray
// became more opaque than clear, < 0 where it has not.
struct Seen {
  vec3 light;
  float clarity;
  float depth;
};

// Whether a point belongs to a segment, or, for `isoSegment`, to what the iso-surface encloses.
const int isoSegment = -2;
// share of the window at a biased value: x per value, y at 0
uniform vec2 grey;

bool insideSegment(vec3 grid, int segment) {
  if (isCutAway(grid)) {
    return false;
  }
  float value = biasedAt(grid);
  return segment == isoSegment ? value * grey.x + grey.y >= 0.0 : segmentAt(grid, value) == segment;
}

// Where the ray is inside a box [grid]; `face` gets the one through which it enters.
vec2 throughBox(vec3 low, vec3 high, vec3 origin, vec3 direction, out vec3 face) {
  vec3 inverse = 1.0 / (mix(vec3(1.0), sign(direction), step(1e-12, abs(direction))) * max(abs(direction), 1e-12));
  vec3 a = (low - origin) * inverse;
  vec3 b = (high - origin) * inverse;
  vec3 near = min(a, b);
  vec3 far = max(a, b);
  float enter = max(max(near.x, near.y), near.z);
  face = -sign(direction) * step(vec3(enter), near);
  return vec2(max(enter, 0.0), min(min(far.x, far.y), far.z));
}

// Where the ray is in displaced tissue.
vec2 throughDisplaced(vec3 origin, vec3 direction) {
  vec3 face;
  vec2 span = vec2(farAway);
#ifdef DISPLACED
  for (int box = 0; box < displacedBoxes; ++box) {
    if (displacedScale[box].x > 0.0) {
      vec3 low = -displacedOffset[box] / displacedScale[box];
      vec2 through = throughBox(low, low + 1.0 / displacedScale[box], origin, direction, face);
      if (through.x < through.y) {
        span = span.x < farAway ? vec2(min(span.x, through.x), max(span.y, through.y)) : through;
      }
    }
  }
#endif
  return span;
}

// Length that can be leapt over from here [mm]; 0 in a filled brick. Bricks tell of voxels: where tissue
// stands beside them less is leapt over.
float emptyAhead(vec3 grid, float t, vec2 displaced, vec3 direction) {
  vec3 place = grid * brickScale + brickOffset;
  vec3 brick = floor(place);
  float reach = floor(texelFetch(brickTexture, ivec3(brick), 0).r * 255.0 + 0.5);
#ifdef DISPLACED
  reach = displaced.x <= t && t < displaced.y ? emptyBeside(reach) : reach;
#endif
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

float noise(vec2 pixel) {
  // interleaved gradient noise: neighbours differ much, so the eye averages it away
  // (Jimenez, "Next generation post processing in Call of Duty", SIGGRAPH 2014)
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

// Leaves of a stretch of a ray what is looked at and what no plane cuts away: what is kept is convex.
void keep(Ray ray, inout vec2 span, inout vec3 face) {
  if (slab.x * ray.stretch > span.x) {
    span.x = slab.x * ray.stretch;
    face = -ray.direction;
  }
  span.y = min(span.y, slab.y * ray.stretch);
  for (int i = 0; i < CLIP_PLANES; ++i) {
    if (i >= clipCount) {
      break;
    }
    float before = dot(clipPlanes[i], vec4(ray.origin, 1.0));
    float rise = dot(clipPlanes[i].xyz, ray.inGrid);
    if (abs(rise) < 1e-7) {
      span.y = before > 0.0 ? 0.0 : span.y;
      continue;
    }
    float t = -before / rise;
    if (rise > 0.0) {
      span.y = min(span.y, t);
    } else if (t > span.x) {
      span.x = t;
      face = clipPlanes[i].xyz / spacing;
    }
  }
}

Ray rayOfPixel() {
  Ray ray;
  vec2 place = (gl_FragCoord.xy + shift.xy) / pictureSize * 2.0 - 1.0;
  vec3 sideways = across * place.x + upward * place.y;
  vec3 toPixel = parallel > 0.5 ? forward : forward + sideways;
  ray.origin = parallel > 0.5 ? eye + sideways / spacing : eye;
  ray.stretch = length(toPixel);
  ray.direction = toPixel / ray.stretch;
  ray.inGrid = ray.direction / spacing;
  ray.span = throughBox(vec3(0.0), dimensions, ray.origin, ray.inGrid, ray.face);
  keep(ray, ray.span, ray.face);
#ifdef SECOND
  mat3 turn = mat3(secondFromGrid);
  ray.other = throughBox(vec3(0.0), vec3(1.0), placeOnSecond(ray.origin), turn * ray.inGrid, ray.otherFace);
  ray.otherFace = normalize((ray.otherFace * turn) / spacing);
  keep(ray, ray.other, ray.otherFace);
#endif
  ray.displaced = throughDisplaced(ray.origin, ray.inGrid);
  ray.start = jitter > 0.5 ? noise(gl_FragCoord.xy + 5.588238 * shift.z) : 0.5;
  return ray;
}

// Length of whole steps to the first sample beyond what is empty from here; 0 where it is not.
float stepsOverEmpty(Ray ray, vec3 grid, float t) {
  float leap = emptyAhead(grid, t, ray.displaced, ray.inGrid);
  return leap > 0.0 ? max(1.0, ceil(leap / stepLength)) * stepLength : 0.0;
}
