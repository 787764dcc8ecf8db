// Probe, device point, line and arrow: meshes in the scene frame [mm].
in vec3 position;
in vec3 normal;

uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform mat3 normalMatrix;

out vec3 normalInView;
out vec3 positionInView;

void main() {
  vec4 inView = viewMatrix * modelMatrix * vec4(position, 1.0);
  normalInView = normalMatrix * normal;
  positionInView = inView.xyz;
  gl_Position = projectionMatrix * inView;
}
