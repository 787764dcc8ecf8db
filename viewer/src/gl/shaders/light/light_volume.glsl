// The light that reaches a place through what is drawn around it: share of the sky (x) and of the lamp
// (y). Worked out coarsely by `gl/march/light_volume.ts`; nothing of it is left where it is not used.

#ifdef LIGHT_VOLUME
uniform sampler3D lightTexture;
// of occlusion and of shadow that is seen
uniform vec2 lightShare;
// from a surface to where its light is looked up [mm]
uniform float lightLead;

// `away`: from the surface, along the grid's axes, up to 1.
vec2 lightAt(vec3 grid, vec3 away) {
  vec3 place = (grid + away * lightLead / spacing) / dimensions;
  return mix(vec2(1.0), texture(lightTexture, place).rg, lightShare);
}
#else
#define lightAt(grid, away) vec2(1.0)
#endif
