/**
 * `window.palpate`: what tests and curious people can read and do from the console.
 */
import type { Letter } from "../../../core/geometry/anatomy";
import { pixelSizeAt, type Camera } from "../../../core/geometry/camera";
import type { Mark } from "../../../core/marks/measure";
import type { Picked } from "../../../core/picking/pick_surface";
import {
  decodeToPage,
  type Registration,
  type Scan,
  type SecondScan,
  type Segment,
  type Settings,
  type State,
} from "../../../core/protocol";
import type { Vec3 } from "../../../core/geometry/vector";
import { benchHooks, type BenchHooks } from "./bench_hooks";
import type { DrawerChoice } from "../../../core/drawing/who_draws";
import type { GpuSupport } from "../../../gl/base/gpu_support";
import type { FieldFilter } from "../../../gl/march/field_filter";
import type { Shown } from "../../../gl/picture/refiner";
import type { ShownSlice } from "../../../gl/picture/slices";
import type { HandControl } from "../../features/touch/hand_control.svelte";
import type { ContactAudio } from "../../features/touch/contact_audio.svelte";
import type { ShownTouch } from "../../../core/touch/shown_touch";
import type { Session } from "../../state/session.svelte";
import type { EditTimes } from "../../features/scan/shown_edits.svelte";
import type { Stage } from "../stage";

export interface TestHooks {
  /** When the first picture stood on the screen [ms since the page was opened], or null; it may be coarse. */
  readonly firstPicture: number | null;
  /** Planes that are drawn with their own values: of the coarse scan at first, then of the arriving one. */
  readonly drawnPlanes: number;
  /** The picture of all of the scan is there and the engine is connected. */
  readonly ready: boolean;
  /** The picture is as fine as it gets. */
  readonly finished: boolean;
  /** With what the picture on display was drawn; null before there is one. */
  readonly shown: Shown | null;
  /** Who draws; where it is not who should, `obstacle` tells why. */
  readonly drawer: { readonly choice: DrawerChoice; readonly engine: boolean; readonly obstacle: string | null };
  /** What is now; null before the engine has reported. */
  readonly state: State | null;
  /** As the engine has listed them last. */
  readonly segments: readonly Segment[];
  /** Version of the labels that the engine has listed last. */
  readonly labelsVersion: number;
  /** Number of the segment whose labels are on display at a place of the grid; 0 for none. */
  readonly labelAt: (grid: Vec3) => number;
  /** As the page shows them; null before the engine has reported. */
  readonly settings: Settings | null;
  /** The settings are shown as the engine holds them, and are kept for the next visit. */
  readonly settingsHold: boolean;
  /** Waits until the engine has done all that the page has asked for by now, and has reported it. */
  readonly allDone: () => Promise<void>;
  /** The scenario's tool that stands in place of the probe; null while the probe is shown. */
  readonly played: ShownTouch | null;
  readonly camera: Camera | null;
  /** The slices on display. */
  readonly slices: readonly ShownSlice[];
  /** How many slices were drawn by now. */
  readonly drawnSlices: number;
  /** The point that all of them go through [scene mm]. */
  readonly crosshair: Vec3 | null;
  readonly cross: (point: Vec3) => void;
  /** Whether contact can be heard, and how loud it is now, 0..1. */
  readonly sound: { readonly running: boolean; readonly level: number };
  /** From the arrival of the last edit until all of it was uploaded to the GPU [ms]; null before the first. */
  readonly lastEditMilliseconds: number | null;
  /** What each of the last edits took on its way. */
  readonly editTimes: readonly EditTimes[];
  /** Number of the last edit on display. */
  readonly lastEdit: number;
  /**
   * Draws nothing any more, or again, while edits are uploaded as always: for `palpate bench edit`,
   * whose budget leaves drawing out.
   */
  readonly suspendDrawing: (on: boolean) => void;
  readonly drawingSuspended: boolean;
  /** Off: the picture at rest is the same however quick the machine is. */
  readonly setJitter: (on: boolean) => void;
  /** Triangles of each segment's surface. */
  readonly triangles: Readonly<Record<number, number>>;
  /** The scan's voxels and their size [mm]; null before there is one. */
  readonly scan: Pick<Scan, "dimensions" | "spacing"> | null;
  /** Size of a CSS pixel at a point [mm]. */
  readonly pixelSizeAt: (point: Vec3) => number;
  /** Of the picture [CSS pixels]. */
  readonly middle: readonly [number, number];
  /** Nodes along the boxes in which tissue is displaced. */
  readonly displaced: readonly Vec3[];
  /** Nodes or particles of the model that are shown. */
  readonly parts: number;
  /** Takes a packed message as if the engine had sent it. */
  readonly receive: (packed: Uint8Array) => void;
  readonly place: (point: Vec3) => void;
  readonly hand: (point: Vec3) => void;
  readonly setView: (direction: Letter) => void;
  /** What stands at a place of the picture [CSS pixels]. */
  readonly pick: (x: number, y: number) => Picked | null;
  /** What the browser's graphics can do. */
  readonly support: GpuSupport;
  /** How the scan's values are filtered, and how far off which formats were; null before there is a canvas. */
  readonly filter: FieldFilter | null;
  readonly bench: BenchHooks;
  /** The second scan, as the engine has reported it; null where there is none. */
  readonly second: SecondScan | null;
  /** How far its registration is; null before the engine has reported. */
  readonly registration: Registration | null;
  /** Points, distances and angles that were set. */
  readonly marks: readonly Mark[];
  /** Sets a mark, as clicks do. */
  readonly addMark: (kind: Mark["kind"], points: readonly Vec3[]) => void;
  /** What is kept with the scan, by the names of its parts. */
  readonly kept: Readonly<Record<string, object>>;
  /** Keeps a part with the scan; a page that is opened then takes it up. */
  readonly keep: (name: string, value: object | null) => void;
}

declare global {
  interface Window {
    palpate?: TestHooks;
  }
}

export function installTestHooks(session: Session, stage: Stage, hand: HandControl, audio: ContactAudio): void {
  window.palpate = {
    get firstPicture() {
      return stage.loader.firstPicture;
    },
    get drawnPlanes() {
      return stage.picture.drawn?.arrived ?? 0;
    },
    get ready() {
      return stage.loader.wholePicture !== null && session.connection.kind === "open" && session.latest !== null;
    },
    get finished() {
      return stage.picture.shown?.finished ?? false;
    },
    get shown() { return stage.picture.shown; },
    get drawer() { return drawerOf(stage); },
    get state() {
      return session.latest;
    },
    get segments() { return session.segments; },
    get labelsVersion() { return session.labels; },
    labelAt: (grid) => shownLabelAt(session, stage, grid),
    get settings() { return session.settings; },
    get settingsHold() {
      return session.settingsHold;
    },
    allDone: () => allDone(session),
    get sound() {
      return { running: audio.running, level: audio.level };
    },
    get played() { return stage.player.shown; },
    get camera() { return stage.view.camera; },
    get slices() { return stage.slices.shown; },
    get drawnSlices() { return stage.picture.drawn?.drawnSlices ?? 0; },
    get crosshair() {
      return stage.slices.crosshair;
    },
    cross: (point) => { stage.slices.goTo(point); },
    get lastEditMilliseconds() {
      return stage.edits.lastMilliseconds;
    },
    get editTimes() {
      return stage.edits.times;
    },
    get lastEdit() {
      return stage.edits.lastEdit;
    },
    suspendDrawing: (on) => { stage.picture.suspend(on); },
    get drawingSuspended() {
      return stage.picture.suspended;
    },
    setJitter: (on) => { stage.picture.setJitter(on); },
    get triangles() {
      return Object.fromEntries([...stage.edits.sizes].map(([id, { triangles }]) => [id, triangles]));
    },
    get scan() {
      return session.scan;
    },
    pixelSizeAt: (point) => pixelSizeIn(stage.view, point),
    get middle() {
      return [stage.view.viewport.width / 2, stage.view.viewport.height / 2] as const;
    },
    get displaced() {
      return stage.edits.displaced.map(({ size }) => size);
    },
    get parts() {
      return session.parts?.count ?? 0;
    },
    receive: (packed) => {
      session.receive(decodeToPage(packed), performance.now());
    },
    place: (point) => { hand.place(point); },
    hand: (point) => { hand.goTo(point); },
    setView: (direction) => { stage.view.lookFrom(direction); },
    pick: (x, y) => stage.picker.at(x, y),
    support: stage.picture.support,
    get filter() { return stage.picture.filter; },
    bench: benchHooks(stage),
    get second() {
      return stage.second.reported;
    },
    get registration() { return stage.registration.reported; },
    get marks() {
      return stage.marks.all;
    },
    addMark: (kind, points) => { stage.marks.add(kind, points); },
    get kept() { return session.memory.everything; },
    keep: (name, value) => { session.memory.keep(name, value); },
  };
}

/** Number of the segment that is seen at a point of the grid by its labels; 0 for none. */
function shownLabelAt(session: Session, stage: Stage, grid: Vec3): number {
  const label = stage.edits.labelAt(grid, stage.loader.held?.volume.step ?? 1);
  return session.segments.some(({ id, visible }) => id === label && visible) ? label : 0;
}

function drawerOf({ drawer: { choice, engineDraws: engine, obstacle } }: Stage): TestHooks["drawer"] {
  return { choice, engine, obstacle };
}

/** Waits until the engine has done all that was asked for. */
async function allDone(session: Session): Promise<void> {
  // some goes out with the next frame
  await new Promise((resolve) => requestAnimationFrame(resolve));
  // what waits for an answer, such as undo, may ask for more
  do {
    await new Promise<void>((resolve) => {
      session.whenAnswered(resolve);
    });
  } while (!session.isSettled);
}

/** Millimetres of a pixel at a point of the scene; NaN before there is a view. */
function pixelSizeIn({ camera, viewport }: Stage["view"], point: Vec3): number {
  return camera === null ? NaN : pixelSizeAt(camera, point, viewport);
}
