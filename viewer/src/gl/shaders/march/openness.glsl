// How much of the sky reaches a surface, from the voxels around it. Who includes this says
// before it what is inside: bool insideSegment(vec3 grid, int segment).

// 1 in a picture in haste
uniform float haste;

// Share of the sky seen from a surface: four cones about the normal and one along it.
float openness(vec3 grid, vec3 normal, int segment) {
  vec3 side = normalize(abs(normal.z) < 0.9 ? cross(normal, vec3(0, 0, 1)) : cross(normal, vec3(1, 0, 0)));
  vec3 other = cross(normal, side);
  float covered = 0.0;
  for (int cone = 0; cone < 5; ++cone) {
    vec2 aside = vec2(cone == 1 ? 1.0 : cone == 2 ? -1.0 : 0.0, cone == 3 ? 1.0 : cone == 4 ? -1.0 : 0.0);
    vec2 tilt = cone == 0 ? vec2(0.0) : aside;
    vec3 direction = normalize(normal + 1.1 * (tilt.x * side + tilt.y * other)) / spacing;
    float hit = 0.0;
    float away = 2.2;
    for (int i = 0; i < 4; ++i) {
      vec3 place = grid + direction * away;
      bool inside = all(greaterThan(place, vec3(0.0))) && all(lessThan(place, dimensions));
      if (inside && insideSegment(place, segment)) {
        // what is far away covers less
        hit = max(hit, 1.0 - float(i) * 0.2);
      }
      away *= 1.9;
    }
    covered += hit;
  }
  return 1.0 - 0.17 * covered;
}

// Share of the sky that the nearest voxels leave a surface; a picture in haste has the light volume's shade alone.
float nearOpenness(vec3 grid, vec3 normal, int segment) {
  return haste > 0.5 ? 1.0 : openness(grid, normal, segment);
}
