/**
 * How the picture is divided into panes. All lengths are CSS pixels, from its upper left corner.
 */
import type { SliceName } from "../slices/slice_plane";

export const layouts = ["view", "slice", "four"] as const;
/** The 3-D view alone, beside one slice, or among three. */
export type Layout = (typeof layouts)[number];

export interface Rect {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export interface Panes {
  readonly view: Rect;
  readonly slices: readonly { readonly name: SliceName; readonly rect: Rect }[];
}

/** Between two panes. */
const gap = 2;
/** The 3-D view's share beside one slice. */
const viewShare = 0.6;

/** The panes of a picture of this size. One slice stands beside the view, or below it where that is wider. */
export function panesOf(
  layout: Layout,
  size: { readonly width: number; readonly height: number },
  single: SliceName,
): Panes {
  const whole: Rect = { x: 0, y: 0, ...size };
  if (layout === "view") {
    return { view: whole, slices: [] };
  }
  if (layout === "slice") {
    const [view, rect] = size.width >= size.height ? beside(whole, viewShare) : below(whole, viewShare);
    return { view, slices: [{ name: single, rect }] };
  }
  const [upper, lower] = below(whole, 0.5);
  const [first, view] = beside(upper, 0.5);
  const [third, fourth] = beside(lower, 0.5);
  return {
    view,
    slices: [
      { name: "axial", rect: first },
      { name: "coronal", rect: third },
      { name: "sagittal", rect: fourth },
    ],
  };
}

function beside({ x, y, width, height }: Rect, share: number): readonly [Rect, Rect] {
  const first = Math.max(1, Math.round(width * share - gap / 2));
  return [
    { x, y, width: first, height },
    { x: x + first + gap, y, width: Math.max(1, width - first - gap), height },
  ];
}

function below({ x, y, width, height }: Rect, share: number): readonly [Rect, Rect] {
  const first = Math.max(1, Math.round(height * share - gap / 2));
  return [
    { x, y, width, height: first },
    { x, y: y + first + gap, width, height: Math.max(1, height - first - gap) },
  ];
}
