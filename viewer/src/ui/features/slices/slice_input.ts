/**
 * The mouse over a slice: with the brush left drag paints, and Shift + wheel, [ and ] change its radius; with the
 * live wire a click sets a point, a double click or Enter closes it, Backspace takes a point back; a level is painted
 * by a click. Where a region is to grow, the left button grows it from there, and dragging on makes it more or less.
 * Else left drag moves the crosshair, a click says what is there or sets a point of a mark or of a pair, right drag
 * sets window and level, middle or Ctrl + left drag moves the picture, the wheel goes through the slices and zooms with
 * Ctrl. Shift + move, or any move where touch mode leads it so, leads the hand in the plane; with the left button held
 * too its tool works on the way. With Shift a double click brings the probe there, without it gives the slice the whole
 * picture, or takes it back. One finger does what the left button does, two zoom and move the picture.
 * With the focus, arrows up and down go through the slices, with Ctrl they move the picture, + and − zoom.
 */
import { FingerPair, type PairMove } from "../../../core/view/finger_pair";
import type { Rect } from "../../../core/view/picture_layout";
import { pointOnSlice, type SliceName, type SlicePlane } from "../../../core/slices/slice_plane";
import { addScaled, type Vec3 } from "../../../core/geometry/vector";
import type { HandControl } from "../touch/hand_control.svelte";
import { clickReach, wheelNotches, wheelPixels } from "../../widgets/mouse";
import type { BrushControl } from "../segments/brush_control.svelte";
import type { GrowControl } from "../segments/grow_control.svelte";
import type { OutlineControl } from "../segments/outline_control.svelte";
import type { SliceControl } from "./slice_control.svelte";

type Drag = "tool" | "crosshair" | "window" | "pan" | "paint" | "area" | "grow" | "fingers";

/** Pixels of the wheel that move the hand by a pixel of the slice. */
const pixelsPerDepth = 20;
/** Parts of notches add up with rounding. */
const rounding = 1e-6;
const zoomSpeed = 0.0014;
/** Zoom by a press of a key. */
const zoomStep = 1.15;
/** Move of the picture by a press of a key, as a drag would [pixels]. */
const panStep = 24;
const panKeys: Readonly<Record<string, readonly [number, number]>> = {
  ArrowRight: [panStep, 0],
  ArrowLeft: [-panStep, 0],
  ArrowDown: [0, panStep],
  ArrowUp: [0, -panStep],
};

/** What clicks in slices are for, beside the brush. */
export interface SliceClicks {
  /** Whether a mark or a pair of points waits for its next point. */
  readonly marking: boolean;
  /** Takes corners of an area that is being set; null where none is. */
  readonly area: {
    readonly putCorner: (point: Vec3, axes: SlicePlane) => void;
    readonly showCorner: (point: Vec3) => void;
  } | null;
  /** A region that may wait for the point that it grows from. */
  readonly growing: Pick<GrowControl, "armed" | "press" | "drag" | "release" | "leave">;
  /** Gives a point to what waits for it; false where nothing does. */
  readonly put: (point: Vec3) => boolean;
  /** Says what is at a point of a slice. */
  readonly describe: (slice: SliceName, point: Vec3) => void;
  /** Says nothing any more. */
  readonly close: () => void;
}

/** A place in a pane, from its upper left corner [CSS pixels]. */
export type Place = Pick<Rect, "x" | "y">;

/** What the mouse over a slice works on. */
export interface SliceTargets {
  readonly slices: SliceControl;
  readonly brush: BrushControl;
  readonly hand: HandControl;
  /** The tool in the hand; none begins to work. */
  readonly tool: { readonly press: () => boolean; readonly release: () => void };
  readonly clicks: SliceClicks;
  /** Told where in the pane the mouse is [CSS pixels]; null once it has left. */
  readonly pointed: (place: Place | null) => void;
}

export class SliceInput {
  private drag: Drag | null = null;
  private last: readonly [number, number] | null = null;
  /** Parts of notches of the wheel that make no slice yet. */
  private turned = 0;
  /** Where the left button went down, as long as that may be a click. */
  private pressed: readonly [number, number] | null = null;
  /** Where an area was begun. */
  private began: readonly [number, number] = [0, 0];
  /** The last press has set a corner of an area. */
  private cornered = false;
  /** The last click has set a point or a corner of a mark: a second one makes no double click of it. */
  private marked = false;
  private readonly fingers = new FingerPair();
  /** Where the crosshair was before the last press. */
  private crossed: Vec3 | null = null;
  private readonly slices: SliceControl;
  private readonly brush: BrushControl;
  private readonly hand: HandControl;
  private readonly tool: SliceTargets["tool"];
  private readonly clicks: SliceClicks;
  private readonly pointed: SliceTargets["pointed"];

  constructor(
    private readonly pane: HTMLElement,
    private readonly name: SliceName,
    targets: SliceTargets,
  ) {
    ({ slices: this.slices, brush: this.brush, hand: this.hand, clicks: this.clicks, pointed: this.pointed } = targets);
    this.tool = targets.tool;
  }

  /** Listens until the returned function is called. */
  listen(): () => void {
    const aborter = new AbortController();
    const on = <K extends keyof HTMLElementEventMap>(type: K, act: (event: HTMLElementEventMap[K]) => void): void => {
      this.pane.addEventListener(type, act, { signal: aborter.signal, passive: false });
    };
    on("pointerdown", this.press.bind(this));
    on("pointermove", this.move.bind(this));
    on("pointerup", this.release.bind(this));
    on("pointercancel", (event) => {
      this.brush.cancel();
      this.release(event);
    });
    on("pointerenter", () => {
      this.slices.pointed = this.name;
      // so that its keys are those of the brush
      if (this.brushes && document.activeElement === document.body) {
        this.pane.focus({ preventScroll: true });
      }
    });
    on("pointerleave", () => {
      this.rest();
      this.slices.pointed = null;
    });
    on("click", this.click.bind(this));
    on("dblclick", this.doubleClick.bind(this));
    on("focus", () => {
      this.slices.focused = this.pane.matches(":focus-visible") ? this.name : null;
    });
    on("blur", () => (this.slices.focused = null));
    on("wheel", this.wheel.bind(this));
    on("keydown", this.key.bind(this));
    on("contextmenu", (event) => {
      event.preventDefault();
    });
    return () => {
      aborter.abort();
      // a pane that goes tells nothing more
      this.slices.pointed = this.slices.pointed === this.name ? null : this.slices.pointed;
      this.slices.focused = this.slices.focused === this.name ? null : this.slices.focused;
    };
  }

  private get plane(): SlicePlane | null {
    return this.slices.planeOf(this.name);
  }

  private pointAt(event: MouseEvent): Vec3 | null {
    const { plane } = this;
    const { width, height } = this.pane.getBoundingClientRect();
    const { x, y } = this.placeOf(event);
    return plane === null ? null : pointOnSlice(plane, x, y, { width, height });
  }

  private placeOf(event: MouseEvent): Place {
    const { left, top } = this.pane.getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  }

  private press(event: PointerEvent): void {
    if (isForControl(event)) {
      return;
    }
    this.cornered = false;
    this.pane.focus({ preventScroll: true });
    this.pane.setPointerCapture(event.pointerId);
    if (event.pointerType === "touch") {
      const { x, y } = this.placeOf(event);
      this.fingers.put(event.pointerId, [x, y]);
    }
    if (this.fingers.count > 1) {
      this.takeBack();
      this.drag = "fingers";
      return;
    }
    this.crossed = this.slices.crosshair;
    if (event.button === 2) {
      this.drag = "window";
    } else if (event.button === 1 || event.ctrlKey) {
      this.drag = "pan";
      event.preventDefault();
    } else if (event.button === 0 && this.clicks.area !== null) {
      this.setCorner(event);
      this.drag = "area";
      this.began = [event.clientX, event.clientY];
    } else if (event.button === 0 && this.clicks.growing.armed && !this.clicks.marking) {
      const point = this.pointAt(event);
      if (point !== null) {
        this.drag = "grow";
        this.clicks.growing.press(point);
      }
    } else if (event.button === 0 && this.brushes && this.outline === null) {
      const { plane } = this;
      const point = this.pointAt(event);
      if (plane !== null && point !== null) {
        this.drag = "paint";
        this.brush.begin(point, plane.toward);
      }
    } else if (event.button === 0 && event.shiftKey && this.leads(event) && !this.clicks.marking) {
      this.drag = "tool";
      this.began = [event.clientX, event.clientY];
    } else if (event.button === 0 && !this.leads(event) && !this.clicks.marking && this.outline === null) {
      this.drag = "crosshair";
      this.moveCrosshair(event);
    }
    this.last = [event.clientX, event.clientY];
    this.pressed =
      event.button === 0 &&
      this.drag !== "area" &&
      (this.drag === "crosshair" || this.clicks.marking || this.outlines(event))
        ? this.last
        : null;
  }

  /** Takes back what one finger began, where a second one comes. */
  private takeBack(): void {
    if (this.drag === "crosshair" && this.crossed !== null) {
      this.slices.goTo(this.crossed);
    } else if (this.drag === "paint") {
      this.brush.cancel();
    } else if (this.drag === "grow") {
      this.clicks.growing.leave();
    } else if (this.drag === "tool") {
      this.tool.release();
    }
    this.pressed = null;
  }

  /** Two fingers zoom about the place between them, and move the picture. */
  private follow({ x, y, spread, middle }: PairMove): void {
    this.slices.pan(this.name, x, y);
    this.slices.zoom(this.name, 1 / spread, ...middle);
  }

  private move(event: PointerEvent): void {
    const place = this.placeOf(event);
    const pair = this.fingers.move(event.pointerId, [place.x, place.y]);
    if (this.drag === "fingers") {
      if (pair !== null) this.follow(pair);
      return;
    }
    if (isForControl(event)) {
      this.rest();
      return;
    }
    const [lastX, lastY] = this.last ?? [event.clientX, event.clientY];
    const [x, y] = [event.clientX - lastX, event.clientY - lastY];
    this.last = [event.clientX, event.clientY];
    this.pointed(place);
    if (
      this.pressed !== null &&
      Math.hypot(event.clientX - this.pressed[0], event.clientY - this.pressed[1]) >= clickReach
    ) {
      this.pressed = null;
    }
    if (x === 0 && y === 0) {
      return;
    }
    const sets = this.clicks.area !== null && (this.drag === null || this.drag === "area");
    const corner = sets ? this.pointAt(event) : null;
    if (this.drag === "grow") {
      this.clicks.growing.drag(x, y);
    } else if (corner !== null) {
      this.clicks.area?.showCorner(corner);
    } else if (this.drag === "paint") {
      const point = this.pointAt(event);
      if (point !== null) this.brush.move(point);
    } else if (this.drag === "crosshair") {
      this.moveCrosshair(event);
    } else if (this.drag === "window") {
      this.slices.dragWindow(x, y);
    } else if (this.drag === "pan") {
      this.slices.pan(this.name, x, y);
    } else if (this.drag === "tool" || this.leads(event)) {
      // a press alone may be the first of a double click, which brings the probe elsewhere
      if (this.drag === "tool" && this.movedFar(event)) this.tool.press();
      this.leadHand(x, y);
    } else {
      this.show(event);
    }
  }

  /** The mouse points at no place of the slice. */
  private rest(): void {
    this.last = null;
    this.pointed(null);
    this.outline?.leave();
  }

  /** Shows where an outline would go. */
  private show(event: PointerEvent): void {
    const [{ plane }, point] = [this, this.pointAt(event)];
    if (plane !== null && point !== null) {
      this.outline?.point(this.name, point, plane.toward);
    }
  }

  private release(event: PointerEvent): void {
    if (this.drag === "paint") {
      this.brush.end();
    } else if (this.drag === "area" && event.type === "pointerup" && this.movedFar(event)) {
      this.setCorner(event);
    } else if (this.drag === "grow") {
      if (event.type === "pointerup") this.clicks.growing.release();
      else this.clicks.growing.leave();
    } else if (this.drag === "tool") {
      this.tool.release();
    }
    this.fingers.lift(event.pointerId);
    // a finger that is left alone begins nothing anew
    this.drag = this.drag === "fingers" && this.fingers.count > 0 ? "fingers" : null;
    if (this.pane.hasPointerCapture(event.pointerId)) {
      this.pane.releasePointerCapture(event.pointerId);
    }
  }

  /** Sets a corner of an area: the first where the button goes down, the other there or where it is let go. */
  private setCorner(event: PointerEvent): void {
    const { plane } = this;
    const point = this.pointAt(event);
    if (plane !== null && point !== null) {
      this.clicks.area?.putCorner(point, plane);
      this.cornered = true;
    }
  }

  /** Whether a press was a drag by now. */
  private movedFar({ clientX, clientY }: PointerEvent): boolean {
    return Math.hypot(clientX - this.began[0], clientY - this.began[1]) >= clickReach;
  }

  /** Says what is there, or sets a point of a mark. */
  private click(event: MouseEvent): void {
    const point = this.pointAt(event);
    if (event.detail > 1) {
      return;
    }
    this.marked = this.cornered || (this.pressed !== null && this.clicks.marking);
    if (this.pressed === null || point === null) {
      return;
    }
    this.pressed = null;
    if (this.clicks.put(point)) {
      return;
    }
    if (this.outline !== null) {
      this.outline.click(this.name, point, this.plane?.toward ?? [0, 0, 1]);
    } else {
      this.clicks.describe(this.name, point);
    }
  }

  /** Closes an outline, brings the probe there or gives the slice the whole picture. */
  private doubleClick(event: MouseEvent): void {
    const point = this.pointAt(event);
    if (isForControl(event) || this.outline?.close() === true || point === null || this.marked || this.brushes) {
      return;
    }
    this.clicks.close();
    if (this.leads(event)) {
      this.hand.place(point);
    } else {
      this.slices.toggleAlone(this.name);
    }
  }

  /** Whether the left button paints: what waits for a click comes first. */
  private get brushes(): boolean {
    return this.brush.ready && !this.clicks.marking && !this.clicks.growing.armed;
  }

  /** What draws outlines by clicks; null where the left button does something else. */
  private get outline(): OutlineControl | null {
    const { habits, outline } = this.brush;
    return this.brushes && habits.way !== "brush" ? outline : null;
  }

  /** Whether a press may be a click that draws an outline. */
  private outlines(event: MouseEvent): boolean {
    return this.outline !== null && this.drag === null && !event.ctrlKey;
  }

  /** Whether moves of the mouse lead the hand. */
  private leads(event: MouseEvent): boolean {
    return !this.brushes && (event.shiftKey || this.hand.leadsByMoves);
  }

  private moveCrosshair(event: MouseEvent): void {
    const point = this.pointAt(event);
    if (point !== null) {
      this.slices.goTo(point);
    }
  }

  /** Moves the hand by pixels of this slice. */
  private leadHand(right: number, down: number): void {
    const { plane } = this;
    if (plane !== null) {
      this.hand.moveBy(
        addScaled(addScaled([0, 0, 0], plane.right, right * plane.pixel), plane.up, -down * plane.pixel),
      );
    }
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const turned = wheelPixels(event);
    const { plane } = this;
    if (event.ctrlKey) {
      const { x, y } = this.placeOf(event);
      this.slices.zoom(this.name, Math.exp(turned * zoomSpeed), x, y);
    } else if (event.shiftKey && this.brushes) {
      this.brush.resize(-Math.sign(turned));
    } else if (this.leads(event) && plane !== null) {
      this.hand.moveBy(addScaled([0, 0, 0], plane.toward, (turned / pixelsPerDepth) * plane.pixel));
    } else {
      this.page(wheelNotches(event));
    }
  }

  /** Goes on by a slice for each notch; parts of notches add up until the wheel turns back. */
  private page(notches: number): void {
    const before = Math.sign(notches) === -Math.sign(this.turned) ? 0 : this.turned;
    const turned = before + notches;
    const whole = Math.trunc(turned + Math.sign(turned) * rounding);
    this.turned = turned - whole;
    if (whole !== 0) {
      this.slices.scroll(this.name, -whole);
    }
  }

  private key(event: KeyboardEvent): void {
    if (isForControl(event, "keys")) {
      return;
    }
    const { width, height } = this.pane.getBoundingClientRect();
    const slices = { ArrowUp: 1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    const size = this.brushes ? { "[": -1, "]": 1 }[event.key] : undefined;
    const factor = { "+": 1 / zoomStep, "=": 1 / zoomStep, "-": zoomStep }[event.key];
    const drawn = this.outline !== null ? { Enter: "close", Backspace: "back" }[event.key] : undefined;
    if (drawn !== undefined) {
      const does = drawn === "close" ? this.outline?.close() : this.outline?.back();
      if (does === true) {
        event.preventDefault();
        event.stopPropagation();
      }
      return;
    }
    const move = panKeys[event.key];
    if ((event.ctrlKey || event.metaKey) && move !== undefined) {
      event.preventDefault();
      event.stopPropagation();
      this.slices.pan(this.name, ...move);
      return;
    }
    if (event.ctrlKey || event.metaKey || (slices === undefined && factor === undefined && size === undefined)) {
      return;
    }
    // else the key would move the hand or change the probe
    event.preventDefault();
    event.stopPropagation();
    if (size !== undefined) {
      this.brush.resize(size);
    } else if (slices !== undefined) {
      this.slices.scroll(this.name, slices);
    } else if (factor !== undefined) {
      this.slices.zoom(this.name, factor, width / 2, height / 2);
    }
  }
}

/** Whether an event belongs to a control that stands over the slice; one may leave the keys to it. */
function isForControl({ target }: Event, what: "mouse" | "keys" = "mouse"): boolean {
  const control = target instanceof Element ? target.closest<HTMLElement>("[data-controls]") : null;
  return control !== null && (what === "mouse" || control.dataset["controls"] !== "mouse");
}
