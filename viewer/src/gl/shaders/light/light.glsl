// Light of the picture: a key light over the viewer's left shoulder, a soft sky and ground.
// All vectors are unit vectors in mm, in one and the same frame. Colours are linear.
// Source: Blinn, "Models of light reflection", SIGGRAPH (1977); the cone sampling of
// occlusion follows Hernell et al., "Local ambient occlusion", IEEE TVCG 16 (2010).

uniform vec3 keyDirection;
uniform vec3 upDirection;
// factors on ambient, diffuse and specular light, and on the sharpness of highlights
uniform vec4 material;

const vec3 keyColour = vec3(1.06, 1.0, 0.92);
const vec3 skyColour = vec3(0.36, 0.38, 0.42);
const vec3 groundColour = vec3(0.14, 0.11, 0.10);

vec3 skyAt(vec3 normal) {
  return mix(groundColour, skyColour, 0.5 + 0.5 * dot(normal, upDirection));
}

// Solid surface; `near` is the share of the sky that what stands close leaves it, `light` what all around
// lets through of sky and lamp; `own` are a segment's factors on ambient and specular light.
vec3 litSurface(vec3 colour, vec3 normal, vec3 toEye, float near, vec2 light, vec2 own) {
  vec2 factors = own * material.xz;
  float open = min(near, light.x);
  float key = max(dot(normal, keyDirection), 0.0);
  float facing = max(dot(normal, toEye), 0.0);
  vec3 halfway = normalize(keyDirection + toEye);
  float shine = 0.16 * factors.y * pow(max(dot(normal, halfway), 0.0), 28.0 * material.w);

  vec3 sky = factors.x * skyAt(normal) * open;
  vec3 direct = keyColour * (0.82 * material.y * key * light.y) * mix(0.45, 1.0, open);
  // light scattered below the surface warms what is turned away and what is covered
  vec3 scattered = vec3(0.10, 0.055, 0.04) * (1.0 - open) + 0.04 * (1.0 - facing);
  return colour * (sky + direct + factors.x * scattered) + shine * open * light.y;
}

// Translucent tissue; `edge` tells how much of a surface it is here, 0..1, `light` what reaches it of sky
// and lamp, `own` as above.
vec3 litTissue(vec3 colour, vec3 normal, vec3 toEye, float edge, vec2 light, vec2 own) {
  vec2 factors = own * material.xz;
  float wrapped = max((dot(normal, keyDirection) + 0.35) / 1.35, 0.0);
  float rim = pow(1.0 - max(dot(normal, toEye), 0.0), 3.0);
  vec3 halfway = normalize(keyDirection + toEye);
  float shine = 0.22 * factors.y * pow(max(dot(normal, halfway), 0.0), 36.0 * material.w);

  vec3 sky = factors.x * light.x * (skyAt(normal) + 0.18 * rim);
  vec3 surface = colour * (sky + keyColour * (0.85 * material.y * light.y * wrapped)) + shine * light.y;
  // flat tissue has no direction: it glows with all of the light
  return mix(colour * (0.2 * factors.x * light.x + 0.35 * material.y * light.y), surface, edge);
}
