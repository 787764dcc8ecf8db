/**
 * How the picture is divided into panes. All lengths are CSS pixels, from its upper left corner.
 */
import type { SliceName } from "../slices/slice_plane";

export const layouts = ["view", "slice", "four", "big", "slices"] as const;
/**
 * The 3-D view alone, beside one slice, or among three; one slice large with the others and the 3-D view beside it; three
 * slices without the 3-D view.
 */
export type Layout = (typeof layouts)[number];

export const layoutNames: Readonly<Record<Layout, string>> = {
  view: "3-D view alone",
  slice: "3-D view with a slice",
  four: "3-D view with three slices",
  big: "One slice large",
  slices: "Three slices",
};

export interface Rect {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export interface Panes {
  readonly view: Rect;
  /** Else the 3-D view is small and stands outside of the picture: its camera stays, and it costs nothing. */
  readonly viewShown: boolean;
  readonly slices: readonly { readonly name: SliceName; readonly rect: Rect }[];
}

/** Between two panes. */
const gap = 2;
/** The 3-D view's share beside one slice. */
const viewShare = 0.6;
/** Of the large slice beside smaller panes. */
const largeShare = 0.72;

/** Of a 3-D view that is not seen. */
const nowhere: Rect = { x: -64, y: 0, width: 64, height: 48 };

/**
 * The panes of a picture of this size. One slice stands beside the view, or below it where that is wider.
 *
 * @param single the slice that is seen where there is one, or large.
 * @param alone the pane that has the whole picture for now.
 */
export function panesOf(
  layout: Layout,
  size: { readonly width: number; readonly height: number },
  single: SliceName,
  alone: SliceName | "view" | null = null,
): Panes {
  const whole: Rect = { x: 0, y: 0, ...size };
  const wide = size.width >= size.height;
  if (alone === "view" || (alone === null && layout === "view")) {
    return { view: whole, viewShown: true, slices: [] };
  }
  if (alone !== null) {
    return { view: nowhere, viewShown: false, slices: [{ name: alone, rect: whole }] };
  }
  if (layout === "slice") {
    const [view, rect] = wide ? beside(whole, viewShare) : below(whole, viewShare);
    return { view, viewShown: true, slices: [{ name: single, rect }] };
  }
  const body = ["axial", "coronal", "sagittal"] as const;
  if (layout === "slices") {
    const rects = wide ? thirds(whole, beside) : thirds(whole, below);
    return { view: nowhere, viewShown: false, slices: zip(body, rects) };
  }
  if (layout === "big") {
    const [large, rest] = wide ? beside(whole, largeShare) : below(whole, largeShare);
    const [view, ...rects] = wide ? thirds(rest, below) : thirds(rest, beside);
    const others = body.filter((name) => name !== single).slice(0, 2);
    return { view, viewShown: true, slices: [{ name: single, rect: large }, ...zip(others, rects)] };
  }
  const [upper, lower] = below(whole, 0.5);
  const [first, view] = beside(upper, 0.5);
  return { view, viewShown: true, slices: zip(body, [first, ...beside(lower, 0.5)]) };
}

function zip(names: readonly SliceName[], rects: readonly Rect[]): Panes["slices"] {
  return rects.map((rect, i) => ({ name: names[i] ?? "axial", rect }));
}

/** Three equal parts. */
function thirds(rect: Rect, cut: typeof beside): readonly [Rect, Rect, Rect] {
  const [first, rest] = cut(rect, 1 / 3);
  return [first, ...cut(rest, 0.5)];
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
