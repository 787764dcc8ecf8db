// Nodes or particles of a model of deformation: discs that face the viewer; scene [mm].
in vec3 position;
// shares of the box
in vec3 place;
// -1 where pressed, 1 where pulled
in float strain;

uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform vec3 boxOrigin;
uniform vec3 boxSize;
// of a disc [mm]
uniform float radius;

out vec2 onDisc;
out float shownStrain;

void main() {
  vec4 inView = viewMatrix * vec4(boxOrigin + place * boxSize, 1.0);
  // what is strained is what is looked for
  inView.xy += position.xy * radius * mix(0.6, 1.4, min(1.0, 2.0 * abs(strain)));
  onDisc = position.xy;
  shownStrain = strain;
  gl_Position = projectionMatrix * inView;
}
