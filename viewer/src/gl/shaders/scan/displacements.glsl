// Displacements of tissue from the voxels that show it. The scan is pulled back through them:
// what is seen at a place is what the scan holds where that place's tissue is at rest.
// DISPLACED is defined where a model of deformation is at work; else nothing of this is left.
// Keep in sync with `gl/textures/displacement_texture.ts`.

uniform vec3 spacing;

#ifdef DISPLACED
// that of what is pressed, and that of the body behind
const int displacedBoxes = 2;
// how far tissue is displaced from its voxels, along the grid's axes [mm]: the boxes one above the other
uniform sampler3D displacedTexture;
// share of a box = grid * scale + offset; a box that is not there holds no place
uniform vec3 displacedScale[displacedBoxes];
uniform vec3 displacedOffset[displacedBoxes];
// texture = share * part + start, between the outermost nodes, which are `edge` inside
uniform vec3 displacedPart[displacedBoxes];
uniform vec3 displacedStart[displacedBoxes];
uniform vec3 displacedEdge[displacedBoxes];
// no tissue stands farther from its voxels along an axis [mm]
uniform float displacedFarthest;
// edge of a brick [voxels], or less: see `core/scan/bricks.ts`
const float brickVoxels = 8.0;

bool isInBox(int box, vec3 grid) {
  vec3 place = grid * displacedScale[box] + displacedOffset[box];
  return all(lessThan(abs(place - 0.5), vec3(0.5)));
}

bool isDisplaced(vec3 grid) {
  return isInBox(0, grid) || isInBox(1, grid);
}

// By the boxes that hold a place, at that place or near it [mm].
vec3 displacementNear(vec3 held, vec3 grid) {
  vec3 sum = vec3(0.0);
  for (int box = 0; box < displacedBoxes; ++box) {
    if (isInBox(box, held)) {
      vec3 share = grid * displacedScale[box] + displacedOffset[box];
      share = clamp(share, displacedEdge[box], 1.0 - displacedEdge[box]);
      sum += textureLod(displacedTexture, share * displacedPart[box] + displacedStart[box], 0.0).xyz;
    }
  }
  return sum;
}

// Where the tissue that stands here is at rest, by two steps of a fixed-point iteration.
vec3 atRest(vec3 grid) {
  if (!isDisplaced(grid)) {
    return grid;
  }
  vec3 first = grid - displacementNear(grid, grid) / spacing;
  return grid - displacementNear(grid, first) / spacing;
}

// Bricks that are empty from a place on as far as tissue may stand beside its voxels, of those that are.
float emptyBeside(float bricks) {
  float smallest = min(spacing.x, min(spacing.y, spacing.z));
  return max(bricks - ceil(displacedFarthest / (brickVoxels * smallest)), 0.0);
}
#else
#define atRest(grid) (grid)
#endif
