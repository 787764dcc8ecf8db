// Probe, device point, line, arrows and contact: meshes in the scene frame [mm].
in vec3 position;
in vec3 normal;

uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform mat3 normalMatrix;
// what lies on a surface is drawn this far before it [mm]
uniform float toward;

out vec3 normalInView;
out vec3 positionInView;

void main() {
  vec4 inView = viewMatrix * modelMatrix * vec4(position, 1.0);
  // in an orthographic view the eye is straight ahead
  vec3 toEye = projectionMatrix[3][3] > 0.5 ? vec3(0.0, 0.0, 1.0) : -inView.xyz / max(length(inView.xyz), 1e-6);
  inView.xyz += toward * toEye;
  normalInView = normalMatrix * normal;
  positionInView = inView.xyz;
  gl_Position = projectionMatrix * inView;
}
