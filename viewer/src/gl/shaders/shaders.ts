/**
 * The shaders, joined from their files. WebGL2 (GLSL ES 3.00).
 */
import anaglyphFrag from "./picture/anaglyph.frag?raw";
import blends from "./march/blends.glsl?raw";
import bricks from "./march/bricks.glsl?raw";
import cellLight from "./light/cell_light.frag?raw";
import cellOpacity from "./light/cell_opacity.frag?raw";
import cells from "./light/cells.glsl?raw";
import clip from "./march/clip.glsl?raw";
import compositeFrag from "./picture/composite.frag?raw";
import displaced from "./scan/displacements.glsl?raw";
import engineFrag from "./picture/engine.frag?raw";
import enlargeFrag from "./picture/upscale.frag?raw";
import facing from "./march/facing.glsl?raw";
import field from "./scan/field.glsl?raw";
import first from "./march/first.glsl?raw";
import fullscreenVert from "./picture/fullscreen.vert?raw";
import gaugeFrag from "./markers/gauge.frag?raw";
import gaugeVert from "./markers/gauge.vert?raw";
import iso from "./march/iso.glsl?raw";
import light from "./light/light.glsl?raw";
import lightVolume from "./light/light_volume.glsl?raw";
import marchFrag from "./march/march.frag?raw";
import markFrag from "./markers/mark.frag?raw";
import markVert from "./markers/mark.vert?raw";
import markerFrag from "./markers/marker.frag?raw";
import markerVert from "./markers/marker.vert?raw";
import openness from "./march/openness.glsl?raw";
import ownSegment from "./surfaces/own_segment.glsl?raw";
import partsFrag from "./markers/particles.frag?raw";
import partsVert from "./markers/particles.vert?raw";
import pathFrag from "./markers/path.frag?raw";
import pathVert from "./markers/path.vert?raw";
import projection from "./march/projection.glsl?raw";
import ray from "./march/ray.glsl?raw";
import second from "./second/second.glsl?raw";
import secondGrey from "./second/second_grey.glsl?raw";
import secondLines from "./second/second_lines.glsl?raw";
import secondRay from "./second/second_ray.glsl?raw";
import secondSlice from "./second/second_slice.glsl?raw";
import secondTissue from "./second/second_tissue.glsl?raw";
import seenDepthFrag from "./picture/seen_depth.frag?raw";
import segments from "./scan/segments.glsl?raw";
import shells from "./march/shells.glsl?raw";
import sliceFrag from "./picture/slice.frag?raw";
import solid from "./march/solid.glsl?raw";
import stretchFrag from "./picture/stretch.frag?raw";
import surfaceFrag from "./surfaces/surface.frag?raw";
import surfaceVert from "./surfaces/surface.vert?raw";
import surfaces from "./surfaces/surfaces.glsl?raw";
import toldValues from "./scan/told_values.frag?raw";
import tissue from "./march/tissue.glsl?raw";
import transfer from "./march/transfer.glsl?raw";
import turnedFrag from "./picture/turned.frag?raw";

const precision =
  "precision highp float;\nprecision highp int;\nprecision highp sampler2D;\nprecision highp sampler3D;\n";

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
  march: joined(
    blends,
    displaced,
    field,
    segments,
    surfaces,
    light,
    lightVolume,
    clip,
    bricks,
    second,
    ray,
    openness,
    alongRays,
    marchFrag,
  ),
  toldValues: joined(displaced, field, toldValues),
  cellOpacity: joined(blends, displaced, field, segments, clip, bricks, transfer, cells, cellOpacity),
  cellLight: joined(displaced, field, segments, bricks, cells, cellLight),
  composite: joined(compositeFrag),
  engine: joined(surfaces, engineFrag),
  enlarge: joined(enlargeFrag),
  stretch: joined(stretchFrag),
  seenDepth: joined(seenDepthFrag),
  turned: joined(turnedFrag),
  anaglyph: joined(anaglyphFrag),
  slice: joined(displaced, field, segments, second, secondGrey, secondSlice, secondLines, sliceFrag),
  gauge: { vertex: joined(gaugeVert), fragment: joined(gaugeFrag) },
  mark: { vertex: joined(markVert), fragment: joined(markFrag) },
  marker: { vertex: joined(markerVert), fragment: joined(markerFrag) },
  surface: {
    vertex: joined(displaced, surfaceVert),
    fragment: joined(displaced, field, clip, ownSegment, light, lightVolume, openness, surfaceFrag),
  },
  parts: { vertex: joined(partsVert), fragment: joined(partsFrag) },
  path: { vertex: joined(pathVert), fragment: joined(pathFrag) },
};
