/**
 * The mouse over the picture: turn, move, zoom, and the hand.
 *
 * Left drag turns, middle or Ctrl + left drag moves the picture, the wheel zooms. Right drag,
 * Shift + move, or any move in touch mode moves the hand in the view plane; meanwhile the
 * wheel moves it in depth. Alt + left drag changes window and level of what is seen. Where a segment is to be cut, the
 * left button paints the line. With a tool chosen, the left button presses it wherever the mouse moves the hand without
 * a button. A click says what is seen there, sets a point of a mark, or grows a region; a double click brings the probe
 * to it.
 */
import { orbit, pan, zoom } from "../../core/geometry/camera";
import type { PickedOfTwo } from "../../core/picking/pick_scans";
import { addScaled } from "../../core/geometry/vector";
import type { HandControl } from "../features/touch/hand_control.svelte";
import type { Reading } from "../features/picking/readout.svelte";
import type { Session } from "../state/session.svelte";
import type { Stage } from "./stage";
import { clickReach, wheelPixels } from "../widgets/mouse";
import type { ToolHand } from "../features/tools/tool_hand.svelte";

type Drag = "orbit" | "pan" | "hand" | "tool" | "cut" | "look";

/** Turn per pixel [rad]. */
const turnSpeed = 0.0075;
/** Zoom per pixel of the wheel, as an exponent. */
const zoomSpeed = 0.0014;
/** Move in depth per pixel of the wheel [pixels of the picture]. */
const depthSpeed = 0.05;
/** Where a double click puts the probe: this far before what was seen [mm]. */
const standOff = 3;
/** A click that is to grow a region means what lies this far behind what is seen [mm]. */
const growDepth = 3;

export class PointerInput {
  private drag: Drag | null = null;
  /** Where the left button went down, as long as that may be a click. */
  private pressed: readonly [number, number] | null = null;
  /** The last click has set a point of a mark: a second one makes no double click of it. */
  private marked = false;
  private last: readonly [number, number] | null = null;

  constructor(
    private readonly canvas: HTMLElement,
    private readonly session: Session,
    private readonly stage: Stage,
    private readonly hand: HandControl,
    private readonly tool: ToolHand,
  ) {}

  /** Listens until the returned function is called. */
  listen(): () => void {
    const aborter = new AbortController();
    const on = <K extends keyof HTMLElementEventMap>(type: K, act: (event: HTMLElementEventMap[K]) => void): void => {
      this.canvas.addEventListener(type, act, { signal: aborter.signal, passive: false });
    };
    on("pointerdown", this.press.bind(this));
    on("pointermove", this.move.bind(this));
    on("pointerup", this.release.bind(this));
    on("pointercancel", this.release.bind(this));
    on("pointerleave", () => (this.last = null));
    on("click", this.click.bind(this));
    on("dblclick", this.bringProbe.bind(this));
    on("wheel", this.wheel.bind(this));
    on("contextmenu", (event) => {
      event.preventDefault();
    });
    return () => {
      aborter.abort();
    };
  }

  private press(event: PointerEvent): void {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    if (event.button === 2) {
      this.drag = "hand";
    } else if (event.button === 1 || event.ctrlKey) {
      this.drag = "pan";
      event.preventDefault();
    } else if (event.button === 0 && event.altKey) {
      this.drag = "look";
    } else if (event.button === 0 && this.stage.cutting.id !== null) {
      this.drag = "cut";
      this.stage.cutting.begin(this.placeOf(event));
    } else if (event.button === 0) {
      this.drag = (event.shiftKey || this.hand.touchMode) && this.tool.press() ? "tool" : "orbit";
    }
    this.last = [event.clientX, event.clientY];
    const leads = event.shiftKey || this.hand.touchMode;
    this.pressed = this.drag === "orbit" && (!leads || this.stage.marks.placing !== null) ? this.last : null;
  }

  private move(event: PointerEvent): void {
    const [lastX, lastY] = this.last ?? [event.clientX, event.clientY];
    const [right, down] = this.stage.stereo.eyes[0]?.stretch ?? [1, 1];
    const x = (event.clientX - lastX) * right;
    const y = (event.clientY - lastY) * down;
    this.last = [event.clientX, event.clientY];
    if (
      this.pressed !== null &&
      Math.hypot(event.clientX - this.pressed[0], event.clientY - this.pressed[1]) >= clickReach
    ) {
      this.pressed = null;
    }
    const { camera, viewport } = this.stage.view;
    if (camera === null || (x === 0 && y === 0)) {
      return;
    }
    if (this.drag === "cut") {
      this.stage.cutting.paint(this.placeOf(event));
      return;
    }
    if (this.drag === "look") {
      this.stage.appearance.drag(x, y);
      return;
    }
    const doing = this.drag === "orbit" && event.shiftKey ? "hand" : this.drag;
    if (doing === "orbit") {
      this.stage.view.camera = orbit(camera, x * turnSpeed, y * turnSpeed);
    } else if (doing === "pan") {
      this.stage.view.camera = pan(camera, x, y, viewport);
    } else if (doing === "hand" || doing === "tool" || event.shiftKey || this.hand.touchMode) {
      this.hand.move(x, y, 0);
    }
  }

  private release(event: PointerEvent): void {
    const { cutting, stereo } = this.stage;
    const eye = stereo.at(event.offsetX, event.offsetY);
    if (this.drag === "tool") {
      this.tool.release();
    } else if (this.drag === "cut" && eye !== null) {
      cutting.finish(eye.camera, eye.viewport);
    }
    this.drag = null;
    if (this.canvas.hasPointerCapture(event.pointerId)) {
      this.canvas.releasePointerCapture(event.pointerId);
    }
  }

  /** Where an event is in what the eye sees that it points with. */
  private placeOf({ offsetX, offsetY }: MouseEvent): readonly [number, number] {
    return this.stage.stereo.at(offsetX, offsetY)?.place ?? [offsetX, offsetY];
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const turned = wheelPixels(event);
    const { objects, view } = this.stage;
    const { camera, content } = view;
    if (event.altKey && camera !== null && objects.holds) {
      objects.turn(camera.back, turned * turnSpeed * 0.1);
    } else if (
      this.drag === "hand" ||
      this.drag === "tool" ||
      event.shiftKey ||
      (this.hand.touchMode && this.drag === null && !event.ctrlKey)
    ) {
      this.hand.move(0, 0, -turned * depthSpeed);
    } else if (camera !== null && content !== null) {
      this.stage.view.camera = zoom(camera, Math.exp(turned * zoomSpeed), content);
    }
  }

  /** Says what is seen there, sets a point of a mark on it, or grows a region from it. */
  private click(event: MouseEvent): void {
    if (this.pressed === null || event.detail > 1) {
      return;
    }
    this.pressed = null;
    const { growing, marks, readout } = this.stage;
    const { camera } = this.stage.view;
    const picked = this.stage.picker.at(event.offsetX, event.offsetY);
    this.marked = marks.placing !== null;
    if (picked === null) {
      readout.close();
    } else if (this.marked) {
      marks.put(picked.point);
    } else if (growing.armed && camera !== null) {
      growing.from(addScaled(picked.point, camera.back, -growDepth));
    } else {
      readout.show(this.readingOf(picked));
    }
  }

  private readingOf({ point, segment, value, scan }: PickedOfTwo): Reading {
    const { picker } = this.stage;
    if (scan === "second") {
      return { pane: "view", point, value: picker.valueAt(point), name: picker.segmentAt(point)?.name ?? null, scan };
    }
    const found = this.session.segments.find(({ id }) => id === segment);
    return { pane: "view", point, value, name: found?.name ?? null, scan };
  }

  private bringProbe(event: MouseEvent): void {
    // two short strokes are no double click, nor are two short lines, nor two points of a mark
    if (this.stage.cutting.id !== null || this.marked) {
      return;
    }
    if (this.tool.kind !== "none" && (event.shiftKey || this.hand.touchMode)) {
      return;
    }
    const picked = this.stage.picker.at(event.offsetX, event.offsetY);
    const { camera } = this.stage.view;
    if (picked === null || camera === null) {
      this.stage.readout.close();
      this.session.notify("info", "Nothing is drawn there: double-click on the scan to bring the probe to it.");
      return;
    }
    this.stage.readout.name(this.readingOf(picked));
    this.hand.place(addScaled(picked.point, camera.back, standOff));
  }
}
