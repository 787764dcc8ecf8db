// How far from each brick nothing is drawn, in bricks; 0 in one that holds something (gl/march/empty_space.ts).

uniform sampler3D brickTexture;
uniform vec3 brickScale;
uniform vec3 brickOffset;
