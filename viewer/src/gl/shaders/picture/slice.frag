// A slice through the scan: its values by window and level, segments as tints and outlines.
// Values become grey on the screen as they are: no gamma, as radiologists read them.

layout(location = 0) out vec4 screen;

// lower left corner of the pane on the screen
uniform vec2 paneCorner;
// the place of that corner in the grid, and from pixel to pixel
uniform vec3 gridCorner;
uniform vec3 gridRight;
uniform vec3 gridUp;
// from sample to sample of a slab; their number; 0 mean, 1 largest, 2 least
uniform vec3 slabStep;
uniform int slabSamples;
uniform int slabMode;
// value that is black, and grey per value
uniform vec2 window;
// opacity of tints and of outlines
uniform vec2 marks;
// thickness of outlines [pixels]
uniform float outline;
uniform vec3 ground;
// edge of a pixel [mm]
uniform float pixelLength;

const int mostSamples = 96;

vec3 srgbFromLinear(vec3 colour) {
  vec3 c = clamp(colour, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, step(c, vec3(0.0031308)));
}

vec3 gridAt(vec2 pixel) {
  return gridCorner + gridRight * pixel.x + gridUp * pixel.y;
}

bool isOutside(vec3 grid) {
  return any(lessThan(grid, vec3(0.0))) || any(greaterThan(grid, dimensions));
}

// Software GL computes both sides of a condition, but no loop that no pixel enters: what few pixels need is a loop.

#ifdef SLAB
float shownValue(vec3 grid) {
  float sum = 0.0;
  float most = -1e9;
  float least = 1e9;
  float count = 0.0;
  for (int i = 0; i < mostSamples; ++i) {
    vec3 place = grid + slabStep * (float(i) - 0.5 * float(slabSamples - 1));
    if (i >= slabSamples) {
      break;
    }
    if (!isOutside(place)) {
      float value = biasedAt(place);
      sum += value;
      most = max(most, value);
      least = min(least, value);
      count += 1.0;
    }
  }
  return slabMode == 0 ? sum / max(count, 1.0) : slabMode == 1 ? most : least;
}
#else
#define shownValue biasedAt
#endif

// The visible segment there; 0 where there is none.
int markOf(vec3 grid, float value) {
  return max(segmentAt(grid, value), 0);
}

int markAt(vec2 pixel) {
  vec3 grid = gridAt(pixel);
  return isOutside(grid) ? 0 : markOf(grid, biasedAt(grid));
}

bool isAtEdge(vec2 pixel, int mark) {
  for (int i = 0; i < 4; ++i) {
    float side = float(i % 2 * 2 - 1);
    if (markAt(pixel + outline * (i < 2 ? vec2(side, 0.0) : vec2(0.0, side))) != mark) {
      return true;
    }
  }
  return false;
}

void main() {
  vec2 pixel = gl_FragCoord.xy - paneCorner;
  vec3 grid = gridAt(pixel);
  gl_FragDepth = 1.0;
  if (isOutside(grid)) {
    screen = vec4(ground, 1.0);
    return;
  }
  float value = shownValue(grid);
  vec3 colour = vec3(clamp((value - window.x) * window.y, 0.0, 1.0));
#ifdef SECOND
  colour = fused(colour, grid, pixel * pixelLength);
#endif
#ifdef MARKS
#ifdef SLAB
  int mark = markAt(pixel);
#else
  int mark = markOf(grid, value);
#endif
  if (mark > 0) {
    bool edge = marks.y > 0.0 && isAtEdge(pixel, mark);
    colour = mix(colour, srgbFromLinear(segmentColour(mark)), edge ? marks.y : marks.x);
  }
#endif
#ifdef SECOND
  colour = withLines(colour, grid, gridRight, gridUp, outline);
#endif
  screen = vec4(colour, 1.0);
}
