// The second scan in the way of a ray: what of it is empty, its gradient, and the light that reaches it.

#ifdef SECOND
uniform sampler3D secondBricks;
// place in its texture -> its bricks
uniform vec3 secondBrickScale;
// number of one of `fusions` (core/second/second_scan.ts), in which the view shows both
uniform int secondViewFusion;

// Cells of a checkerboard run along the first scan's axes, from its corner.
vec3 inCells(vec3 grid) {
  return grid * spacing / secondSquare;
}

// Whether a place shows the second scan and nothing of the first: by turns in cells, or in time.
bool isSecondsTurn(vec3 grid) {
  if (secondViewFusion == 0 || !isOnSecond(placeOnSecond(grid))) {
    return false;
  }
  return secondViewFusion == 1 ? isOdd(inCells(grid)) : secondTurn > 0.5;
}

// Whether it shows the second scan, alone or with the first.
bool showsSecond(vec3 grid) {
  return secondViewFusion == 0 || isSecondsTurn(grid);
}

// The place a little before on the ray, where that lies in the next cell; `face` gets the side between.
bool cameFromNextCell(Ray ray, vec3 grid, out vec3 before, out vec3 face) {
  before = grid - ray.inGrid * (0.1 * stepLength);
  vec3 crossed = abs(floor(inCells(grid)) - floor(inCells(before)));
  face = -sign(ray.direction) * crossed;
  if (secondViewFusion != 1 || face == vec3(0.0)) {
    return false;
  }
  face = normalize(face);
  return true;
}

// Gradient of its biased value along the first scan's axes [per mm], by central differences.
vec3 secondGradient(vec3 grid) {
  vec3 dx = vec3(sampleStep.x, 0.0, 0.0);
  vec3 dy = vec3(0.0, sampleStep.y, 0.0);
  vec3 dz = vec3(0.0, 0.0, sampleStep.z);
  vec3 difference = vec3(
    secondBiased(placeOnSecond(grid + dx)) - secondBiased(placeOnSecond(grid - dx)),
    secondBiased(placeOnSecond(grid + dy)) - secondBiased(placeOnSecond(grid - dy)),
    secondBiased(placeOnSecond(grid + dz)) - secondBiased(placeOnSecond(grid - dz)));
  return difference / (2.0 * sampleStep * spacing);
}

// Light is known where the first scan is, and nothing shades what lies beside it.
vec2 lightOnSecond(vec3 grid, vec3 away) {
  bool within = all(greaterThanEqual(grid, vec3(0.0))) && all(lessThanEqual(grid, dimensions));
  return within ? lightAt(grid, away) : vec2(1.0);
}

// Length along a ray in which nothing of it is drawn [mm]; 0 where something is.
float secondEmptyAhead(vec3 grid, vec3 inGrid) {
  vec3 face;
  vec3 place = placeOnSecond(grid);
  vec3 speed = mat3(secondFromGrid) * inGrid;
  vec2 within = throughBox(vec3(0.0), vec3(1.0), place, speed, face);
  if (within.y <= within.x) {
    return farAway;
  }
  if (within.x > 0.0) {
    return within.x;
  }
  vec3 inBricks = (place * secondTextureScale + secondTextureOffset) * secondBrickScale;
  vec3 brick = floor(clamp(inBricks, vec3(0.0), vec3(textureSize(secondBricks, 0)) - 0.5));
  float reach = floor(texelFetch(secondBricks, ivec3(brick), 0).r * 255.0 + 0.5);
  if (reach == 0.0) {
    return 0.0;
  }
  speed *= secondTextureScale * secondBrickScale;
  vec3 ahead = mix(inBricks - brick + (reach - 1.0), brick + reach - inBricks, step(0.0, speed));
  vec3 lengths = ahead / max(abs(speed), 1e-9);
  return max(min(min(lengths.x, lengths.y), lengths.z), 0.0);
}

// Length of whole steps over what is empty of it from here; 0 where it is not.
float stepsOverSecond(Ray ray, vec3 grid) {
  float leap = secondEmptyAhead(grid, ray.inGrid);
  return leap > 0.0 ? max(1.0, ceil(leap / stepLength)) * stepLength : 0.0;
}

// The segment that is seen at a place: none where the second scan has its turn.
int seenSegmentAt(vec3 grid, float value) {
  return isSecondsTurn(grid) ? 0 : segmentAt(grid, value);
}
#else
#define seenSegmentAt segmentAt
#endif
