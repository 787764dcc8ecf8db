// Displacements of tissue from the voxels that show it. The scan is pulled back through it:
// what is seen at a place is what the scan holds where that place's tissue is at rest.
// DISPLACED is defined where a model of deformation is at work; else nothing of this is left.
// Keep in sync with `gl/textures/displacement_texture.ts`.

uniform vec3 spacing;

#ifdef DISPLACED
// how far tissue is displaced from its voxels, along the grid's axes [mm]; zero at its border
uniform sampler3D displacedTexture;
// texture = grid * scale + offset
uniform vec3 displacedScale;
uniform vec3 displacedOffset;

bool isDisplaced(vec3 grid) {
  vec3 place = grid * displacedScale + displacedOffset;
  return all(lessThan(abs(place - 0.5), vec3(0.5)));
}

// [mm]
vec3 displacementAt(vec3 grid) {
  return texture(displacedTexture, grid * displacedScale + displacedOffset).xyz;
}

// Where the tissue that stands here is at rest, by two steps of a fixed-point iteration.
vec3 atRest(vec3 grid) {
  if (!isDisplaced(grid)) {
    return grid;
  }
  vec3 first = grid - displacementAt(grid) / spacing;
  return grid - displacementAt(first) / spacing;
}
#else
#define atRest(grid) (grid)
#endif
