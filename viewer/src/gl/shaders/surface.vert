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

out vec3 posed;
out vec3 posedNormal;
out vec3 grid;
out vec3 gridNormal;

void main() {
  vec4 inScene = modelMatrix * vec4(position, 1.0);
  posed = inScene.xyz;
  grid = (gridFromPosed * inScene).xyz;
  posedNormal = posedFromSurface * normal;
  gridNormal = gridAxesFromSurface * normal;
  gl_Position = projectionMatrix * viewMatrix * inScene;
}
