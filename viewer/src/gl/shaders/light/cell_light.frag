// The light that reaches a cell: red the share of the sky, green that of the lamp.

layout(location = 0) out vec4 light;

uniform sampler3D opacityTexture;
uniform sampler3D lightBefore;
// 1 where only the lamp has moved
uniform float keepsSky;
uniform vec3 keyDirection;
// how far what stands around takes of the sky [cells]
uniform float skyReach;
// from where on nothing is drawn that could look this cell up [bricks]
uniform float emptyReach;

const int directions = 16;
const int mostCells = 256;

// Share of light that passes `size` cells' edges around a place; nothing is outside of the scan.
float passing(vec3 place, float size) {
  bool outside = any(lessThan(place, vec3(0.0))) || any(greaterThan(place, vec3(1.0)));
  return outside ? 1.0 : pow(1.0 - texture(opacityTexture, place).r, size);
}

// Of all directions: half of them are behind any flat surface, so half is all that there is. What is
// farther away counts for a longer part of the way, and less.
float sky(vec3 here) {
  float sum = 0.0;
  for (int i = 0; i < directions; ++i) {
    // evenly over the sphere (Fibonacci lattice)
    float z = 1.0 - (2.0 * float(i) + 1.0) / float(directions);
    float turn = 2.3999632 * float(i);
    vec3 direction = vec3(sqrt(1.0 - z * z) * vec2(cos(turn), sin(turn)), z) * cellShares;
    float clear = 1.0;
    float size = 1.0;
    for (float from = 0.5; from < skyReach && clear > 0.01; from += size, size *= 1.4) {
      float away = from + 0.5 * size;
      clear *= passing(here + direction * away, size * max(0.0, 1.0 - away / skyReach));
    }
    sum += clear;
  }
  return min(1.0, 2.0 * sum / float(directions));
}

float key(vec3 here) {
  vec3 stride = keyDirection * cellShares;
  float clear = 1.0;
  vec3 place = here + stride;
  for (int i = 0; i < mostCells && clear > 0.01; ++i) {
    if (any(lessThan(place, vec3(0.0))) || any(greaterThan(place, vec3(1.0)))) {
      break;
    }
    clear *= 1.0 - texture(opacityTexture, place).r;
    place += stride;
  }
  return clear;
}

void main() {
  vec3 here = cellPlace();
  if (bricksTellAll() && emptyBricks(here * dimensions) >= emptyReach) {
    light = vec4(1.0);
    return;
  }
  float open = keepsSky > 0.5 ? texelFetch(lightBefore, ivec3(gl_FragCoord.xy, layer), 0).r : sky(here);
  light = vec4(open, key(here), 0.0, 1.0);
}
