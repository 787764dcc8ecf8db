/**
 * The shaders, joined from their files. WebGL2 (GLSL ES 3.00).
 */
import anaglyphFrag from "./shaders/anaglyph.frag?raw";
import blends from "./shaders/blends.glsl?raw";
import bricks from "./shaders/bricks.glsl?raw";
import cellLight from "./shaders/cell_light.frag?raw";
import cellOpacity from "./shaders/cell_opacity.frag?raw";
import cells from "./shaders/cells.glsl?raw";
import clip from "./shaders/clip.glsl?raw";
import compositeFrag from "./shaders/composite.frag?raw";
import displaced from "./shaders/displaced.glsl?raw";
import enlargeFrag from "./shaders/enlarge.frag?raw";
import facing from "./shaders/facing.glsl?raw";
import field from "./shaders/field.glsl?raw";
import first from "./shaders/first.glsl?raw";
import fullscreenVert from "./shaders/fullscreen.vert?raw";
import gaugeFrag from "./shaders/gauge.frag?raw";
import gaugeVert from "./shaders/gauge.vert?raw";
import iso from "./shaders/iso.glsl?raw";
import light from "./shaders/light.glsl?raw";
import lightVolume from "./shaders/light_volume.glsl?raw";
import marchFrag from "./shaders/march.frag?raw";
import markFrag from "./shaders/mark.frag?raw";
import markVert from "./shaders/mark.vert?raw";
import markerFrag from "./shaders/marker.frag?raw";
import markerVert from "./shaders/marker.vert?raw";
import openness from "./shaders/openness.glsl?raw";
import ownSegment from "./shaders/own_segment.glsl?raw";
import partsFrag from "./shaders/parts.frag?raw";
import partsVert from "./shaders/parts.vert?raw";
import pathFrag from "./shaders/path.frag?raw";
import pathVert from "./shaders/path.vert?raw";
import projection from "./shaders/projection.glsl?raw";
import ray from "./shaders/ray.glsl?raw";
import second from "./shaders/second.glsl?raw";
import secondGrey from "./shaders/second_grey.glsl?raw";
import secondRay from "./shaders/second_ray.glsl?raw";
import secondSlice from "./shaders/second_slice.glsl?raw";
import secondTissue from "./shaders/second_tissue.glsl?raw";
import segments from "./shaders/segments.glsl?raw";
import shells from "./shaders/shells.glsl?raw";
import sliceFrag from "./shaders/slice.frag?raw";
import solid from "./shaders/solid.glsl?raw";
import surfaceFrag from "./shaders/surface.frag?raw";
import surfaceVert from "./shaders/surface.vert?raw";
import surfaces from "./shaders/surfaces.glsl?raw";
import tissue from "./shaders/tissue.glsl?raw";
import transfer from "./shaders/transfer.glsl?raw";

const precision = "precision highp float;\nprecision highp int;\nprecision highp sampler2D;\nprecision highp sampler3D;\n";

function joined(...parts: readonly string[]): string {
  return [precision, ...parts].join("\n");
}

// the ray caster has one `seenAlong` for each family of blend modes, and one that is there before all others
const alongRays = `
${secondRay}
${facing}
#if defined(FIRST)
${transfer}
${first}
#elif BLEND <= EMISSION
${transfer}
${solid}
${shells}
${secondTissue}
${tissue}
#elif BLEND <= AVERAGE
${secondGrey}
${projection}
#else
${secondGrey}
${solid}
${shells}
${iso}
#endif`;

export const shaders = {
  fullscreen: joined(fullscreenVert),
  march: joined(blends, displaced, field, segments, surfaces, light, lightVolume, clip, bricks, second, ray, openness, alongRays, marchFrag),
  cellOpacity: joined(blends, displaced, field, segments, clip, bricks, transfer, cells, cellOpacity),
  cellLight: joined(displaced, field, segments, bricks, cells, cellLight),
  composite: joined(compositeFrag),
  enlarge: joined(enlargeFrag),
  anaglyph: joined(anaglyphFrag),
  slice: joined(displaced, field, segments, second, secondGrey, secondSlice, sliceFrag),
  gauge: { vertex: joined(gaugeVert), fragment: joined(gaugeFrag) },
  mark: { vertex: joined(markVert), fragment: joined(markFrag) },
  marker: { vertex: joined(markerVert), fragment: joined(markerFrag) },
  surface: { vertex: joined(displaced, surfaceVert), fragment: joined(displaced, field, clip, ownSegment, light, lightVolume, openness, surfaceFrag) },
  parts: { vertex: joined(partsVert), fragment: joined(partsFrag) },
  path: { vertex: joined(pathVert), fragment: joined(pathFrag) },
};
