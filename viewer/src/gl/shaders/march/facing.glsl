// Unit vector, turned to the viewer; `instead` where there is no direction.
vec3 facing(vec3 vector, vec3 toEye, vec3 instead) {
  float size = length(vector);
  vec3 unit = size > 1e-9 ? vector / size : instead;
  return dot(unit, toEye) < 0.0 ? -unit : unit;
}
