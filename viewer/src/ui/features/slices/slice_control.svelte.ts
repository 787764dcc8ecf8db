/**
 * The slices beside the 3-D view: how the picture is divided, where they lie, and how they look.
 * All of them go through one point, the crosshair.
 */
import { transformPoint } from "../../../core/geometry/affine";
import type { Camera, Viewport } from "../../../core/geometry/camera";
import type { PaneName } from "../../../core/view/pane";
import { panesOf, type Layout, type Panes } from "../../../core/view/picture_layout";
import type { Scan } from "../../../core/protocol";
import { frameOf, type ScanFrame } from "../../../core/scan/scan_volume";
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
} from "../../../core/slices/slice_plane";
import { sliceNumber, slicesBehind, stepSlices, type SliceNumber } from "../../../core/slices/slice_stack";
import { distance, type Vec3 } from "../../../core/geometry/vector";
import {
  draggedWindow,
  firstWindow,
  windowPresets,
  windowsFor,
  type WindowLevel,
  type WindowPreset,
} from "../../../core/appearance/window_level";
import type { ShownSlice, SliceAppearance } from "../../../gl/picture/slices";
import { PageState } from "../../state/page_state.svelte";
import type { PageSteps } from "../../state/page_steps.svelte";
import { recall, remember } from "../../state/remembered";
import type { ScanMemory } from "../../state/scan_memory";

/** The window is kept with the scan under this name. */
const part = "window";

/** What is shown, and not how: remembered whatever scan is open. */
interface Habits {
  readonly layout: Layout;
  /** The slice that is seen where there is only one. */
  readonly single: SliceName;
  /** Slices go where the probe goes. */
  readonly follows: boolean;
  /** The pane that has the whole picture until it goes back; null where all of the layout are seen. */
  readonly alone: PaneName | null;
}

const firstHabits: Habits = { layout: "view", single: "axial", follows: true, alone: null };

/** Layouts that one key goes through. */
const cycled: readonly Layout[] = ["view", "slice", "four"];

/** Slabs and segments on slices, remembered with the habits. */
type Drawing = Pick<SliceAppearance, "slab" | "slabMode" | "fill" | "outline">;

const firstDrawing: Drawing = { slab: 0, slabMode: "mean", fill: 0.15, outline: 0.9 };

/** What of it is changed, as a step of undo says it. @texts */
const drawingNames: Readonly<Record<keyof Drawing, string>> = {
  slab: "slab of slices",
  slabMode: "what slabs show",
  fill: "fill of segments",
  outline: "outline of segments",
};
const drawingKeys = ["slab", "slabMode", "fill", "outline"] as const satisfies readonly (keyof Drawing)[];

/** The probe has moved: less is the rest of a force that settles [mm]. */
const leastMove = 0.05;

export class SliceControl {
  habits = $state.raw<Habits>(recalledHabits(firstHabits));
  /** Through which all slices go [scene mm]; null before there is a scan. */
  crosshair = $state.raw<Vec3 | null>(null);
  /** The slice that the mouse is over, and the one that the keyboard has gone to. */
  pointed = $state.raw<SliceName | null>(null);
  focused = $state.raw<SliceName | null>(null);
  /** Windows by their names, in the order of their keys. */
  presets = $state.raw<readonly WindowPreset[]>(windowPresets);
  /** Size of the whole picture [CSS pixels]. */
  size = $state.raw({ width: 1, height: 1 });

  private frame = $state.raw<ScanFrame | null>(null);
  private first: WindowLevel = { window: 400, level: 40 };
  private views = $state.raw<Partial<Record<SliceName, SliceView>>>({});
  /** The appearance of slices: each change is a step of undo, a whole drag too. */
  private readonly state: PageState<SliceAppearance>;
  private followed: Vec3 | null = null;
  private readonly kept: Partial<Record<SliceName, ShownSlice>> = {};

  /** @param camera of the 3-D view now, along which the oblique slice lies; null before there is a scan. */
  constructor(
    steps: PageSteps,
    private readonly camera: () => Camera | null,
    private readonly memory: ScanMemory,
  ) {
    const first = { ...this.first, ...recalledDrawing() };
    this.state = new PageState<SliceAppearance>(first, steps, ({ window, level }, before) => {
      if (window !== before.window || level !== before.level) {
        memory.keep(part, { window, level });
      }
      this.keep();
    });
    memory.onChange((name) => {
      if (name === part) {
        this.state.take({ ...this.appearance, ...memory.recall(part, this.first) });
      }
    });
  }

  readonly panes = $derived.by((): Panes =>
    panesOf(this.habits.layout, this.size, this.habits.single, this.habits.alone),
  );

  /** The slice that keys are meant for; null where none is. */
  get underKeys(): SliceName | null {
    return this.pointed ?? this.focused;
  }

  /** The place that a saved picture of the 3-D view has the size of: all, where it is not seen. */
  get savedPane(): Viewport {
    return this.panes.viewShown ? this.panes.view : this.size;
  }

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

  get appearance(): SliceAppearance {
    return this.state.now;
  }

  /** Begins with another scan: its middle, all of each slice. */
  open(scan: Scan): void {
    this.frame = frameOf(scan);
    this.first = firstWindow(scan);
    this.presets = windowsFor(scan);
    this.habits = recalledHabits(this.habits);
    this.views = {};
    this.followed = null;
    // of a voxel, so that slices show its values
    const middle = scan.dimensions.map((n) => Math.floor(n / 2) + 0.5) as unknown as Vec3;
    this.crosshair = transformPoint(this.frame.sceneFromGrid, middle);
    this.state.open({ ...this.memory.recall(part, this.first), ...recalledDrawing() });
  }

  /** Another layout has all of its panes seen. */
  change(part: Partial<Habits>): void {
    const alone = part.layout === undefined ? this.habits.alone : null;
    this.habits = { ...this.habits, alone, ...part };
    this.keep();
  }

  /** Shows slices where the 3-D view stands alone. */
  reveal(): void {
    if (this.panes.slices.length === 0) {
      this.change({ layout: this.habits.layout === "view" ? "four" : this.habits.layout });
    }
  }

  /** Gives a pane the whole picture, or all panes their places again. */
  toggleAlone(pane: PaneName): void {
    this.change({ alone: this.habits.alone === null ? pane : null });
  }

  /** Slabs and segments; what is chosen of a list is a step of its own. */
  draw(part: Partial<Drawing>): void {
    const [changed = "slab"] = drawingKeys.filter((key) => key in part && part[key] !== this.appearance[key]);
    this.state.change(drawingNames[changed], { ...this.appearance, ...part }, !("slabMode" in part));
  }

  nextLayout(): void {
    const next = (cycled.indexOf(this.habits.layout) + 1) % cycled.length;
    this.change({ layout: cycled[next] ?? "view" });
  }

  setWindow({ window, level }: WindowLevel): void {
    this.state.change("window and level of slices", { ...this.appearance, window, level }, true);
  }

  /** Takes a window by its place in the list; nothing where there is none. */
  usePreset(place: number): void {
    const preset = this.presets[place];
    if (preset !== undefined) {
      this.setWindow(preset);
    }
  }

  dragWindow(right: number, down: number): void {
    this.setWindow(draggedWindow(this.appearance, right, down));
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
      this.goTo(stepSlices(this.crosshair, axes, this.frame, slices));
    }
  }

  /** Goes to a slice by how many lie behind it, away from the person. */
  goBehind(name: SliceName, behind: number): void {
    const now = this.behind(name);
    if (now !== null) {
      this.scroll(name, behind - now.number);
    }
  }

  /** How many slices lie behind the one that is seen, of all but one; null where slices are not numbered. */
  behind(name: SliceName): SliceNumber | null {
    const axes = this.axesOf(name);
    return axes && this.frame && this.crosshair && slicesBehind(this.crosshair, axes, this.frame);
  }

  /** Which slice is seen, of how many; null where slices are not numbered. */
  numberOf(name: SliceName): SliceNumber | null {
    const axes = this.axesOf(name);
    return axes && this.frame && this.crosshair && sliceNumber(this.crosshair, axes, this.frame);
  }

  /** How thick a slice is, or the slab that it shows [mm]; 0 before there is a scan. */
  thicknessOf(name: SliceName): number {
    const axes = this.axesOf(name);
    const { slab } = this.appearance;
    return slab > 0 ? slab : axes === null || this.frame === null ? 0 : sliceStep(axes, this.frame);
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

  private keep(): void {
    const { slab, slabMode, fill, outline } = this.appearance;
    remember("slices", { ...this.habits, slab, slabMode, fill, outline });
  }

  private axesOf(name: SliceName): SliceAxes | null {
    const camera = this.camera();
    return this.frame === null || camera === null ? null : sliceAxes(name, this.frame.axes, camera);
  }

  private rectOf(name: SliceName): { readonly width: number; readonly height: number } | null {
    return this.panes.slices.find((slice) => slice.name === name)?.rect ?? null;
  }
}

function recalledHabits(fallback: Habits): Habits {
  const { layout, single, follows, alone } = recall("slices", fallback);
  return { layout, single, follows, alone };
}

function recalledDrawing(): Drawing {
  const { slab, slabMode, fill, outline } = recall("slices", firstDrawing);
  return { slab, slabMode, fill, outline };
}

/** The corners of a scan in the scene. */
function cornersOf({ dimensions, sceneFromGrid }: ScanFrame): Vec3[] {
  return [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => {
    const corner = dimensions.map((n, axis) => ((bits >> axis) & 1 ? n : 0)) as unknown as Vec3;
    return transformPoint(sceneFromGrid, corner);
  });
}

