// Which voxels belong to the segment whose surface is drawn.

// low and high biased value of a threshold segment; empty for another one
uniform vec2 ownRange;
// id of a segment that is no threshold; 0 for another one
uniform int ownLabel;

// the grid where the scan has the segment -> the scene where it stands
uniform mat4 posedFromGrid;

#ifdef LABELS
uniform sampler3D labelTexture;
#endif

bool insideSegment(vec3 grid, int segment) {
  if (isCutAway((posedFromGrid * vec4(grid, 1.0)).xyz)) {
    return false;
  }
#ifdef LABELS
  if (ownLabel > 0) {
    return int(texture(labelTexture, atRest(grid) * textureScale + textureOffset).r * 255.0 + 0.5) == ownLabel;
  }
#endif
  float value = biasedAt(grid);
  return ownRange.x <= value && value <= ownRange.y;
}
