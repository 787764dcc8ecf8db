// Surfaces of triangles in the way of a ray: one opaque picture with its depth, and LAYERS
// pictures of translucent ones, near to far. Keep in sync with `gl/textures/surface_layers.ts`.

// near and far plane [mm]
uniform vec2 nearFar;
// 1 in an orthographic view
uniform float parallel;

const float farAway = 1e9;

#ifdef SURFACES
uniform sampler2D surfaceColour;
uniform sampler2D surfaceDepth;
// a surface is drawn this far before it, so that it covers its own voxels [mm]
uniform float surfaceLead;
#if LAYERS > 0
uniform sampler2D layerColour[LAYERS];
uniform sampler2D layerDepth[LAYERS];
#endif
#endif

// What the ray meets: the opaque surface, and translucent ones, at lengths along it [mm].
struct Layers {
  float end;
  vec4 colour;
#if LAYERS > 0
  int next;
  float places[LAYERS];
  vec4 colours[LAYERS];
#endif
};

float windowDepth(float viewDepth) {
  float near = nearFar.x;
  float far = nearFar.y;
  float share = (viewDepth - near) / (far - near);
  return clamp(parallel > 0.5 ? share : share * far / viewDepth, 0.0, 1.0);
}

#ifdef SURFACES
// Length along a ray at which a depth lies; `stretch` is the ray's length per mm of view depth.
float placeOf(float depth, float stretch) {
  float near = nearFar.x;
  float far = nearFar.y;
  float viewDepth = parallel > 0.5 ? mix(near, far, depth) : near * far / (far - depth * (far - near));
  return depth < 1.0 ? viewDepth * stretch - surfaceLead : farAway;
}
#endif

Layers layersOnRay(float stretch) {
  Layers layers;
  layers.end = farAway;
#ifdef SURFACES
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  layers.end = placeOf(texelFetch(surfaceDepth, pixel, 0).r, stretch);
  layers.colour = texelFetch(surfaceColour, pixel, 0);
#define TAKE_LAYER(i) \
  layers.places[i] = placeOf(texelFetch(layerDepth[i], pixel, 0).r, stretch); \
  layers.colours[i] = texelFetch(layerColour[i], pixel, 0);
#if LAYERS > 0
  layers.next = 0;
  TAKE_LAYER(0)
#endif
#if LAYERS > 1
  TAKE_LAYER(1)
#endif
#if LAYERS > 2
  TAKE_LAYER(2)
#endif
#if LAYERS > 3
  TAKE_LAYER(3)
#endif
#endif
  return layers;
}

// Lets the light of all translucent layers before `t` in.
void passLayers(inout Layers layers, float t, inout vec3 light, inout float clarity, inout float depth) {
#if LAYERS > 0
  while (layers.next < LAYERS && layers.places[layers.next] < t) {
    vec4 colour = layers.colours[layers.next];
    light += clarity * colour.rgb;
    clarity *= 1.0 - colour.a;
    depth = depth < 0.0 && clarity < 0.5 ? layers.places[layers.next] + surfaceLead : depth;
    layers.next += 1;
  }
#endif
}

// Ends the ray at the opaque surface, if there is one.
void endAtSurface(Layers layers, inout vec3 light, inout float clarity, inout float depth) {
#ifdef SURFACES
  if (layers.end < farAway) {
    light += clarity * layers.colour.rgb;
    depth = depth < 0.0 ? layers.end + surfaceLead : depth;
    clarity = 0.0;
  }
#endif
}
