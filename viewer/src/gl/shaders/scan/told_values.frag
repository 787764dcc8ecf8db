// What the scan's values are read as at given places (gl/march/field_filter.ts): high byte, low byte and 256ths, which
// any GPU can hand back.

layout(location = 0) out vec4 told;

// in the grid, one for each pixel
uniform sampler2D places;

void main() {
  float value = clamp(biasedAt(texelFetch(places, ivec2(gl_FragCoord.xy), 0).xyz), 0.0, 65535.0);
  float whole = floor(value);
  told = vec4(floor(whole / 256.0), mod(whole, 256.0), floor(256.0 * (value - whole)), 255.0) / 255.0;
}
