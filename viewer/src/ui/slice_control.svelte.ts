/**
 * The slices beside the 3-D view: how the picture is divided, where they lie, and how they look.
 * All of them go through one point, the crosshair.
 */
import { transformPoint } from "../core/affine";
import type { Camera } from "../core/camera";
import { layouts, panesOf, type Layout, type Panes } from "../core/picture_layout";
import type { Scan } from "../core/protocol";
import { frameOf, type ScanFrame } from "../core/scan_volume";
import {
  fitSlice,
  panSlice,
  planeThrough,
  sliceAxes,
  sliceStep,
  zoomSlice,
  type SliceAxes,
  type SliceName,
  type SlicePlane,
  type SliceView,
} from "../core/slice_plane";
import { addScaled, distance, type Vec3 } from "../core/vector";
import { draggedWindow, firstWindow, type WindowLevel } from "../core/window_level";
import type { ShownSlice, SliceLook } from "../gl/slices";
import { recall, remember } from "./remembered";

/** What is remembered whatever scan is open. */
interface Habits {
  readonly layout: Layout;
  /** The slice that is seen where there is only one. */
  readonly single: SliceName;
  /** Slices go where the probe goes. */
  readonly follows: boolean;
  readonly slab: number;
  readonly slabMode: SliceLook["slabMode"];
  readonly fill: number;
  readonly outline: number;
}

const firstHabits: Habits = {
  layout: "view",
  single: "axial",
  follows: true,
  slab: 0,
  slabMode: "mean",
  fill: 0.15,
  outline: 0.9,
};

/** The probe has moved: less is the rest of a force that settles [mm]. */
const leastMove = 0.05;

export class SliceControl {
  habits = $state.raw<Habits>(recall("slices", firstHabits));
  /** Through which all slices go [scene mm]; null before there is a scan. */
  crosshair = $state.raw<Vec3 | null>(null);
  windowLevel = $state.raw<WindowLevel>({ window: 400, level: 40 });
  /** Size of the whole picture [CSS pixels]. */
  size = $state.raw({ width: 1, height: 1 });

  private frame = $state.raw<ScanFrame | null>(null);
  private views = $state.raw<Partial<Record<SliceName, SliceView>>>({});
  private scanName = "";
  private followed: Vec3 | null = null;
  private readonly kept: Partial<Record<SliceName, ShownSlice>> = {};

  /** @param camera of the 3-D view now, along which the oblique slice lies; null before there is a scan. */
  constructor(private readonly camera: () => Camera | null) {}

  readonly panes = $derived.by((): Panes => panesOf(this.habits.layout, this.size, this.habits.single));

  /** The slices as they are seen now; one that has not changed is the same object as before. */
  readonly shown = $derived.by((): readonly ShownSlice[] =>
    this.panes.slices.flatMap(({ name, rect }) => {
      const plane = this.planeOf(name);
      if (plane === null) {
        return [];
      }
      const slice = { name, rect, plane };
      const before = this.kept[name];
      if (before !== undefined && JSON.stringify(before) === JSON.stringify(slice)) {
        return [before];
      }
      this.kept[name] = slice;
      return [slice];
    }),
  );

  readonly look = $derived.by((): SliceLook => {
    const { slab, slabMode, fill, outline } = this.habits;
    return { ...this.windowLevel, slab, slabMode, fill, outline };
  });

  /** Begins with another scan: its middle, all of each slice. */
  open(scan: Scan): void {
    this.frame = frameOf(scan);
    this.scanName = scan.name;
    this.habits = recall("slices", this.habits);
    this.views = {};
    this.followed = null;
    const middle = scan.dimensions.map((n) => n / 2) as unknown as Vec3;
    this.crosshair = transformPoint(this.frame.sceneFromGrid, middle);
    this.windowLevel = recall(`window.${scan.name}`, firstWindow(scan));
  }

  change(part: Partial<Habits>): void {
    this.habits = { ...this.habits, ...part };
    remember("slices", this.habits);
  }

  nextLayout(): void {
    const next = (layouts.indexOf(this.habits.layout) + 1) % layouts.length;
    this.change({ layout: layouts[next] ?? "view" });
  }

  setWindow(windowLevel: WindowLevel): void {
    this.windowLevel = windowLevel;
    remember(`window.${this.scanName}`, windowLevel);
  }

  dragWindow(right: number, down: number): void {
    this.setWindow(draggedWindow(this.windowLevel, right, down));
  }

  /** Moves the crosshair, as far as the scan goes. */
  goTo(point: Vec3): void {
    const { frame } = this;
    if (frame !== null) {
      const grid = transformPoint(frame.gridFromScene, point).map((c, axis) =>
        Math.min(Math.max(c, 0), frame.dimensions[axis] ?? 0),
      ) as unknown as Vec3;
      this.crosshair = transformPoint(frame.sceneFromGrid, grid);
    }
  }

  /** Takes the crosshair along with the probe, where it moves and slices are to follow. */
  follow(probe: Vec3): void {
    const { followed } = this;
    if (followed !== null && distance(followed, probe) < leastMove) {
      return;
    }
    this.followed = probe;
    // where it stands first is no move of it
    if (followed !== null && this.habits.follows) {
      this.goTo(probe);
    }
  }

  /** Goes through the scan by whole slices, toward the person. */
  scroll(name: SliceName, slices: number): void {
    const axes = this.axesOf(name);
    if (axes !== null && this.frame !== null && this.crosshair !== null) {
      this.goTo(addScaled(this.crosshair, axes.toward, slices * sliceStep(axes, this.frame)));
    }
  }

  pan(name: SliceName, x: number, y: number): void {
    const plane = this.planeOf(name);
    if (plane !== null) {
      this.views = { ...this.views, [name]: panSlice(plane, x, y) };
    }
  }

  zoom(name: SliceName, factor: number, x: number, y: number): void {
    const plane = this.planeOf(name);
    const rect = this.rectOf(name);
    if (plane !== null && rect !== null) {
      this.views = { ...this.views, [name]: zoomSlice(plane, factor, x, y, rect) };
    }
  }

  /** Shows all of each slice. */
  fit(): void {
    this.views = {};
  }

  /** A slice as it is seen; null before there is a scan or where it is not shown. */
  planeOf(name: SliceName): SlicePlane | null {
    const axes = this.axesOf(name);
    const rect = this.rectOf(name);
    const { crosshair, frame } = this;
    if (axes === null || rect === null || crosshair === null || frame === null) {
      return null;
    }
    // a part of the scan that was chosen stays in the middle when the pane changes its size
    const view = this.views[name] ?? fitSlice(axes, cornersOf(frame), rect);
    return planeThrough(crosshair, axes, view);
  }

  private axesOf(name: SliceName): SliceAxes | null {
    const camera = this.camera();
    return this.frame === null || camera === null ? null : sliceAxes(name, this.frame.axes, camera);
  }

  private rectOf(name: SliceName): { readonly width: number; readonly height: number } | null {
    return this.panes.slices.find((slice) => slice.name === name)?.rect ?? null;
  }
}

/** The corners of a scan in the scene. */
function cornersOf({ dimensions, sceneFromGrid }: ScanFrame): Vec3[] {
  return [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => {
    const corner = dimensions.map((n, axis) => ((bits >> axis) & 1 ? n : 0)) as unknown as Vec3;
    return transformPoint(sceneFromGrid, corner);
  });
}

