// A layer of the coarse cells in which light is worked out (gl/march/light_volume.ts).

// along the scan's axes, and the number of the layer
uniform vec3 cells;
uniform float layer;
// edge of a cell [mm], and what it is of the scan along each axis
uniform float cellEdge;
uniform vec3 cellShares;

// The cell's middle as a share of the scan.
vec3 cellPlace() {
  return vec3(gl_FragCoord.xy, layer + 0.5) / cells;
}

// How far from here nothing is drawn [bricks]; 0 in a brick that holds something, and less where tissue stands
// beside its voxels.
float emptyBricks(vec3 grid) {
  ivec3 brick = ivec3(clamp(grid * brickScale + brickOffset, vec3(0.0), vec3(textureSize(brickTexture, 0) - 1)));
  float reach = floor(texelFetch(brickTexture, brick, 0).r * 255.0 + 0.5);
#ifdef DISPLACED
  reach = isDisplaced(grid) ? emptyBeside(reach) : reach;
#endif
  return reach;
}

// Segments that are seen by their surfaces shade too, and bricks know nothing of those that are a threshold.
bool bricksTellAll() {
  for (int i = 0; i < RANGES; ++i) {
    if (i < rangeCount && rangeBounds[i].z < 0.0) {
      return false;
    }
  }
  return true;
}
