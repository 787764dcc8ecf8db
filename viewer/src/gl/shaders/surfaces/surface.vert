// A patch of a segment's surface. Positions are shares of the patch's box; `modelMatrix`
// takes them to where the segment stands in the scene [mm].
in vec3 position;
in vec3 normal;

uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
// the scene where the segment stands -> the grid where the scan has it
uniform mat4 gridFromPosed;
// of the segment's pose; and into the grid's axes in mm
uniform mat3 posedFromSurface;
uniform mat3 gridAxesFromSurface;

#ifdef DISPLACED
// 1 where its segment stands where the scan has it, so that a model may have displaced its tissue
uniform float displaceable;
#endif

out vec3 posed;
out vec3 posedNormal;
out vec3 grid;
out vec3 gridNormal;

#ifdef DISPLACED
// How a normal turns with the tissue around it: by the inverse transpose of the displacements'
// gradient, from differences over a voxel.
vec3 turned(vec3 gridNormal) {
  mat3 gradient = mat3(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    vec3 reach = vec3(0.0);
    reach[axis] = 0.5;
    gradient[axis] += (displacementNear(grid, grid + reach) - displacementNear(grid, grid - reach)) / spacing[axis];
  }
  // tissue that is folded has no side
  return determinant(gradient) > 0.1 ? transpose(inverse(gradient)) * gridNormal : gridNormal;
}
#endif

void main() {
  vec4 inScene = modelMatrix * vec4(position, 1.0);
  grid = (gridFromPosed * inScene).xyz;
  posedNormal = posedFromSurface * normal;
  gridNormal = gridAxesFromSurface * normal;
#ifdef DISPLACED
  if (displaceable > 0.5 && isDisplaced(grid)) {
    mat3 surfaceFromGridAxes = transpose(gridAxesFromSurface);
    vec3 moved = displacementNear(grid, grid);
    gridNormal = turned(gridNormal);
    grid += moved / spacing;
    inScene.xyz += surfaceFromGridAxes * moved;
    posedNormal = surfaceFromGridAxes * gridNormal;
  }
#endif
  posed = inScene.xyz;
  gl_Position = projectionMatrix * viewMatrix * inScene;
}
