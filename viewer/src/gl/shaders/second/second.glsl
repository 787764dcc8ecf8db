// A second scan that is shown with the first (core/second/second_scan.ts). Values are biased stored values of it,
// looked up through one matrix. Nothing of this is left where there is none.

#ifdef SECOND
uniform sampler3D secondTexture;
// the first scan's grid -> shares of the second
uniform mat4 secondFromGrid;
// texture = share * scale + offset; holds the subsampling
uniform vec3 secondTextureScale;
uniform vec3 secondTextureOffset;
// edge of a square or a cell in which one of both is seen [mm], and 1 while the second one of two that
// flicker is
uniform float secondSquare;
uniform float secondTurn;

// Whether the second of two has its turn at a place that is counted in squares or cells.
bool isOdd(vec3 place) {
  vec3 cell = floor(place);
  return mod(cell.x + cell.y + cell.z, 2.0) > 0.5;
}

vec3 placeOnSecond(vec3 grid) {
  return (secondFromGrid * vec4(grid, 1.0)).xyz;
}

bool isOnSecond(vec3 place) {
  return all(greaterThanEqual(place, vec3(0.0))) && all(lessThanEqual(place, vec3(1.0)));
}

float secondBiased(vec3 share) {
  return storedIn(filtered(secondTexture, share * secondTextureScale + secondTextureOffset));
}

float secondTexel(ivec3 place) {
  return storedIn(texelFetch(secondTexture, place, 0));
}
#endif
