// Ray casting of the scan into the cached picture (premultiplied linear colour) and its depth: where
// the ray became more opaque than clear. What is seen along a ray is told by `seenAlong`, of which
// there is one for each family of blend modes (tissue.glsl, projection.glsl, iso.glsl). Surfaces of
// triangles stand in the ray at their depth (surfaces.glsl). Bricks that hold nothing drawn are leapt
// over in whole steps, so that skipping changes no pixel.

layout(location = 0) out vec4 picture;

void main() {
  Ray ray = rayOfPixel();
  Layers layers = layersOnRay(ray.stretch);
  ray.span.y = min(ray.span.y, layers.end);
#ifdef SECOND
  ray.other.y = min(ray.other.y, layers.end);
#endif
  Seen seen = seenAlong(ray, layers);
  if (seen.clarity > clearEnough) {
    passLayers(layers, farAway, seen.light, seen.clarity, seen.depth);
    endAtSurface(layers, seen.light, seen.clarity, seen.depth);
  }

#if BLEND == EMISSION
  // light is added to what is behind, and covers it as far as it outshines it
  float opacity = max(1.0 - seen.clarity, min(1.0, max(max(seen.light.r, seen.light.g), seen.light.b)));
  picture = vec4(seen.light, opacity);
#else
  // what early termination left out would have looked like the rest
  float opacity = seen.clarity <= clearEnough ? 1.0 : 1.0 - seen.clarity;
#if BLEND == MIP || BLEND == MINIP || BLEND == AVERAGE
  picture = vec4(seen.light, opacity);
#else
  picture = vec4(seen.light * (opacity / max(1.0 - seen.clarity, 1e-6)), opacity);
#endif
#endif
  gl_FragDepth = seen.depth < 0.0 ? 1.0 : windowDepth(seen.depth / ray.stretch);
}
