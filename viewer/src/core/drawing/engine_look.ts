/**
 * How the scan is drawn as the engine is told it: appearance, segments and clip planes in one message.
 */
import { linearFromSrgb } from "../base/colour";
import type { LookSecond, LookSegment, LookSurface, PictureLook, Segment } from "../protocol";
import type { SecondAppearance } from "../second/second_scan";
import {
  drawnAsSurface,
  drawnFromVoxels,
  shownByValue,
  type InsideModes,
  type ShownRange,
} from "../segments/shown_segments";
import type { Plane } from "../view/clip";
import type { Appearance } from "../appearance/appearance";
import { isGrey, type Blend } from "../appearance/optics";
import { sample, type TransferFunction } from "../appearance/transfer_function";

/** The engine divides by spans of values, which are none where all tissue of a scan has one value [value]. */
const leastSpan = 1e-6;

/** What of segments decides how voxels look. */
export interface LookedSegments {
  readonly segments: readonly Segment[];
  readonly modes: InsideModes;
}

/** @param second how a second scan is shown; null where there is none. */
export function engineLook(
  appearance: Appearance,
  shown: LookedSegments,
  clip: readonly Plane[],
  second: SecondAppearance | null = null,
): PictureLook {
  const { edgeGradient, lighting, optics, ranges, transferFunction } = appearance;
  const { ambient, diffuse, specular, shininess, edges, occlusion, shadow } = lighting;
  return {
    type: "picture_look",
    mode: optics.blend,
    density: optics.density,
    transfer: pointsOf(transferFunction),
    edge_gradient: Math.max(edgeGradient, leastSpan),
    window: [Math.max(optics.window.window, leastSpan), optics.window.level],
    iso_value: optics.isoValue,
    iso_colour: sample(transferFunction.points, optics.isoValue).colour,
    tissue_from: optics.tissueFrom,
    slab: optics.slab,
    lighting: { ambient, diffuse, specular, shininess, edges, occlusion, shadow },
    segments: [...byValue(ranges, shown.segments), ...byLabel(shown)],
    surfaces: shown.segments.filter(drawnAsSurface).map(surfaceOf),
    clip: clip.map(({ normal, offset }) => [normal, offset]),
    second: second === null || !isSeen(second) ? null : secondLook(second, optics.blend),
  };
}

function pointsOf({ points }: TransferFunction): PictureLook["transfer"] {
  return points.map(({ value, colour, extinction }) => [value, colour, extinction]);
}

/** Not while the first of two has its turn. */
function isSeen({ inView, viewFusion, turn }: SecondAppearance): boolean {
  return inView && (viewFusion !== "flicker" || turn === "second");
}

const turnsOf = { blend: "together", checkerboard: "cells", flicker: "second" } as const;

function secondLook(second: SecondAppearance, blend: Blend): LookSecond {
  const { density, edgeGradient, isoValue, opacity, tissueFrom, tint, transferFunction, windows } = second;
  const { window, level } = isGrey(blend) ? windows[blend] : windows.mip;
  return {
    density,
    transfer: pointsOf(transferFunction),
    edge_gradient: Math.max(edgeGradient, leastSpan),
    window: [Math.max(window, leastSpan), level],
    iso_value: isoValue,
    iso_colour: sample(transferFunction.points, isoValue).colour,
    tissue_from: tissueFrom,
    tint,
    opacity,
    turns: turnsOf[second.viewFusion],
    cells: second.square,
  };
}

/** Segments that their values tell of, in the order of the ranges. */
function byValue(ranges: readonly ShownRange[], segments: readonly Segment[]): LookSegment[] {
  return ranges.flatMap(({ id, colour, label, material = [1, 1], tinted, visible }) => {
    const segment = segments.find((other) => other.id === id);
    const range = segment?.range ?? segment?.made_by ?? null;
    const shown = !visible ? "hidden" : tinted === true ? "tinted" : "solid";
    const [ambient, specular] = material;
    return range === null ? [] : [{ id, range, edited: label > 0, shown, colour, ambient, specular }];
  });
}

function surfaceOf({ id, colour, opacity, wireframe, ambient, specular }: Segment): LookSurface {
  return { id, colour: linearFromSrgb(colour), opacity, wireframe, ambient, specular };
}

/** Segments that only their voxels tell of; hidden ones look as the scan does. */
function byLabel({ segments, modes }: LookedSegments): LookSegment[] {
  const told = new Set(shownByValue(segments).map(({ id }) => id));
  return segments
    .filter(({ id, range, visible }) => !told.has(id) && range === null && visible)
    .flatMap((segment) => {
      const { id, ambient, specular } = segment;
      const mode = drawnFromVoxels(segment) ? (modes[id] ?? "solid") : "hidden";
      const colour = linearFromSrgb(segment.colour);
      return mode === "plain" ? [] : [{ id, range: null, edited: false, shown: mode, colour, ambient, specular }];
    });
}
