/**
 * Slices: planes through the scan, seen as radiologists see them. Axial slices are seen from the
 * feet and coronal ones from before, so that the patient's left is at the right of the picture;
 * sagittal ones from the patient's left, so that anterior is at its left.
 *
 * Frame: scene [mm]; places in the picture are CSS pixels from its upper left corner.
 */
import { directions } from "../geometry/anatomy";
import type { Camera, Viewport } from "../geometry/camera";
import type { ScanFrame } from "../scan/scan_volume";
import { add, addScaled, cross, dot, normalize, scale, subtract, type Vec3 } from "../geometry/vector";

export const sliceNames = ["axial", "coronal", "sagittal", "oblique"] as const;
export type SliceName = (typeof sliceNames)[number];

// @texts
const alongBody: Readonly<Record<SliceName, string>> = {
  axial: "axial",
  coronal: "coronal",
  sagittal: "sagittal",
  oblique: "oblique",
};

/** Axes of the scan along which slices lie where the sides of the body are not known. @texts */
const alongScan: Readonly<Record<SliceName, string>> = {
  axial: "x–y",
  coronal: "x–z",
  sagittal: "y–z",
  oblique: "oblique",
};

/** What a slice is called: by the planes of the body where its sides are known. */
export function sliceTitle(name: SliceName, known: boolean): string {
  return (known ? alongBody : alongScan)[name];
}

/** Unit axes of a slice's picture: to the right, up, and toward the person. */
export interface SliceAxes {
  readonly right: Vec3;
  readonly up: Vec3;
  readonly toward: Vec3;
}

/** Which part of a slice is seen: a point in the middle of the picture, and mm per CSS pixel. */
export interface SliceView {
  readonly centre: Vec3;
  readonly pixel: number;
}

/** A slice as it is seen. Its plane holds `centre`. */
export interface SlicePlane extends SliceAxes, SliceView {}

const wanted: Readonly<Record<Exclude<SliceName, "oblique">, { readonly up: Vec3; readonly toward: Vec3 }>> = {
  axial: { up: directions.A, toward: directions.I },
  coronal: { up: directions.S, toward: directions.A },
  sagittal: { up: directions.S, toward: directions.L },
};

/** Share of its usual extent that a slice fills when all of it is shown. */
const filled = 0.94;
/** How near and how far a slice can be seen [mm per CSS pixel]. */
const pixels = { least: 0.005, most: 20 } as const;

/**
 * Axes of a slice. Those along the body follow the scan's own axes that are nearest to them, so that a
 * slice of an oblique scan shows its voxels as they are; the oblique one lies as the 3-D view does.
 */
export function sliceAxes(name: SliceName, axes: ScanFrame["axes"], camera: Camera): SliceAxes {
  if (name === "oblique") {
    return { right: camera.right, up: camera.up, toward: camera.back };
  }
  const toward = nearest(wanted[name].toward, axes);
  const rest = axes.filter((axis) => Math.abs(dot(axis, toward)) < 0.5);
  const up = nearest(wanted[name].up, rest);
  return { right: normalize(cross(up, toward)), up, toward };
}

/** The axis, or its opposite, that points most nearly in a direction. */
function nearest(direction: Vec3, axes: readonly Vec3[]): Vec3 {
  const share = (axis: Vec3): number => dot(axis, direction);
  const best = axes.reduce((a, b) => (Math.abs(share(b)) > Math.abs(share(a)) ? b : a));
  return share(best) < 0 ? scale(best, -1) : best;
}

/** The slice through a point, seen as before. */
export function planeThrough(point: Vec3, axes: SliceAxes, view: SliceView): SlicePlane {
  const depth = dot(subtract(point, view.centre), axes.toward);
  return { ...axes, pixel: view.pixel, centre: addScaled(view.centre, axes.toward, depth) };
}

/** The view that shows all of an outline [points of the scene]. */
export function fitSlice(axes: SliceAxes, outline: readonly Vec3[], viewport: Viewport): SliceView {
  const along = (axis: Vec3): readonly [number, number] => {
    const places = outline.map((point) => dot(point, axis));
    return [Math.min(...places), Math.max(...places)];
  };
  const [left, right] = along(axes.right);
  const [bottom, top] = along(axes.up);
  const [back, front] = along(axes.toward);
  const pixel = Math.max((right - left) / viewport.width, (top - bottom) / viewport.height) / filled;
  const centre = [
    scale(axes.right, (left + right) / 2),
    scale(axes.up, (bottom + top) / 2),
    scale(axes.toward, (back + front) / 2),
  ].reduce(add);
  return { centre, pixel: withinPixels(pixel) };
}

/** Where a point stands in the picture, and how far before the plane [mm]. */
export function placeOnSlice(
  plane: SlicePlane,
  point: Vec3,
  viewport: Viewport,
): { readonly x: number; readonly y: number; readonly before: number } {
  const offset = subtract(point, plane.centre);
  return {
    x: viewport.width / 2 + dot(offset, plane.right) / plane.pixel,
    y: viewport.height / 2 - dot(offset, plane.up) / plane.pixel,
    before: dot(offset, plane.toward),
  };
}

/** The point of the plane that is seen at a place. */
export function pointOnSlice(plane: SlicePlane, x: number, y: number, viewport: Viewport): Vec3 {
  return addScaled(
    addScaled(plane.centre, plane.right, (x - viewport.width / 2) * plane.pixel),
    plane.up,
    (viewport.height / 2 - y) * plane.pixel,
  );
}

/** Moves what is seen by pixels. */
export function panSlice(plane: SlicePlane, x: number, y: number): SliceView {
  const centre = addScaled(addScaled(plane.centre, plane.right, -x * plane.pixel), plane.up, y * plane.pixel);
  return { centre, pixel: plane.pixel };
}

/** Comes nearer (`factor` < 1) or goes away; what is seen at a place stays there. */
export function zoomSlice(plane: SlicePlane, factor: number, x: number, y: number, viewport: Viewport): SliceView {
  const pixel = withinPixels(plane.pixel * factor);
  const held = pointOnSlice(plane, x, y, viewport);
  const seen = pointOnSlice({ ...plane, pixel }, x, y, viewport);
  return { centre: add(plane.centre, subtract(held, seen)), pixel };
}

function withinPixels(pixel: number): number {
  // comparisons with NaN are false
  return pixel > pixels.least ? Math.min(pixel, pixels.most) : pixels.least;
}

/** From one slice to the next [mm]: a voxel along its normal. */
export function sliceStep({ toward }: SliceAxes, { axes, spacing }: ScanFrame): number {
  const size = axes.reduce((sum, axis, i) => sum + (dot(axis, toward) / (spacing[i] ?? 1)) ** 2, 0);
  return 1 / Math.sqrt(size);
}
