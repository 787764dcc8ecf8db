/**
 * The mouse over the picture: turn, move, zoom, and the hand.
 *
 * Left drag turns, middle or Ctrl + left drag moves the picture, the wheel zooms. In touch mode the left button presses
 * on what is drawn (`touch_pointer.ts`), and the wheel changes with how much; where it is chosen so, any move moves the
 * hand in the view plane. Right drag or Shift + move always do that; meanwhile the wheel moves the hand in depth. Alt +
 * left drag changes window and level of what is seen. Where a segment is to be cut, the left button paints the line,
 * until one parts it: that can be looked at from all sides. With a tool chosen, Shift + left has it work. A click says
 * what is seen there or sets a point of a mark; where a region is to grow, the left button grows it from what is seen
 * there, and dragging on makes it more or less; a double click brings the probe to it. Of a touch
 * screen one finger is the left button; two move the picture and zoom as they go apart, in touch mode, where one finger
 * touches, they turn it and zoom.
 */
import { orbit, pan, zoom } from "../../../core/geometry/camera";
import type { PickedOfTwo } from "../../../core/picking/pick_scans";
import { addScaled } from "../../../core/geometry/vector";
import { FingerPair, type PairMove } from "../../../core/view/finger_pair";
import { armedLine, paintedLine } from "../../features/segments/painted_line.svelte";
import type { HandControl } from "../../features/touch/hand_control.svelte";
import type { Reading } from "../../features/picking/readout.svelte";
import type { Session } from "../../state/session.svelte";
import type { Stage } from "../stage";
import { TouchPointer } from "./touch_pointer";
import { clickReach, wheelPixels } from "../../widgets/mouse";
import type { ToolHand } from "../../features/tools/tool_hand.svelte";

type Drag = "orbit" | "pan" | "fingers" | "hand" | "touch" | "tool" | "cut" | "look" | "grow";

/** Turn per pixel [rad]. */
const turnSpeed = 0.0075;
/** Zoom per pixel of the wheel, as an exponent. */
const zoomSpeed = 0.0014;
/** Move in depth per pixel of the wheel [pixels of the picture]. */
const depthSpeed = 0.05;
/** Where a double click puts the probe: this far before what was seen [mm]. */
const standOff = 3;
/** A press that is to grow a region means what lies this far behind what is seen [mm]. */
const growDepth = 3;

export class PointerInput {
  private drag: Drag | null = null;
  /** Where the left button went down, as long as that may be a click. */
  private pressed: readonly [number, number] | null = null;
  /** The last click has set a point of a mark: a second one makes no double click of it. */
  private marked = false;
  private last: readonly [number, number] | null = null;
  private readonly fingers = new FingerPair();
  private readonly touching: TouchPointer;

  constructor(
    private readonly canvas: HTMLElement,
    private readonly session: Session,
    private readonly stage: Stage,
    private readonly hand: HandControl,
    private readonly tool: ToolHand,
  ) {
    this.touching = new TouchPointer(session, stage, hand);
  }

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
    on("lostpointercapture", this.release.bind(this));
    // a page that is not looked at presses on nothing
    window.addEventListener("blur", this.leave.bind(this), { signal: aborter.signal });
    on("pointerleave", () => {
      this.last = null;
      this.stage.pointed.leave();
    });
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
    if (event.pointerType === "touch") {
      this.fingers.put(event.pointerId, this.placeOf(event));
    }
    if (this.fingers.count > 1) {
      this.finish(event);
      this.drag = "fingers";
      this.pressed = null;
      this.last = null;
      return;
    }
    if (event.button === 2) {
      this.drag = "hand";
    } else if (event.button === 1 || event.ctrlKey) {
      this.drag = "pan";
      event.preventDefault();
    } else if (event.button === 0 && event.altKey) {
      this.drag = "look";
    } else if (event.button === 0 && paintedLine(this.stage) !== null) {
      this.drag = "cut";
      paintedLine(this.stage)?.begin(this.placeOf(event));
    } else if (event.button === 0 && this.stage.growing.armed && this.grow(event)) {
      this.drag = "grow";
    } else if (event.button === 0) {
      this.drag = this.leftDrag(event);
    }
    this.last = [event.clientX, event.clientY];
    const leads = event.shiftKey || this.hand.touchMode;
    this.pressed = this.drag === "orbit" && (!leads || this.waitsForClick) ? this.last : null;
  }

  /** What the left button does: with Shift it has the tool work, on a surface it touches, else it turns the picture. */
  private leftDrag(event: PointerEvent): Drag {
    const works = event.shiftKey && this.tool.press();
    if (!this.waitsForClick && this.touching.ready && this.touching.press(event)) {
      return "touch";
    }
    return works ? "tool" : "orbit";
  }

  private move(event: PointerEvent): void {
    this.point(event);
    const pair = this.fingers.move(event.pointerId, this.placeOf(event));
    if (this.drag === "fingers") {
      this.lead(pair);
      return;
    }
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
      armedLine(this.stage)?.paint(this.placeOf(event));
      return;
    }
    if (this.drag === "look") {
      this.stage.appearance.drag(x, y);
      return;
    }
    if (this.drag === "touch") {
      this.touching.move(event);
      return;
    }
    if (this.drag === "grow") {
      this.stage.growing.drag(x, y);
      return;
    }
    const doing = this.drag === "orbit" && event.shiftKey ? "hand" : this.drag;
    if (doing === "orbit") {
      this.stage.view.camera = orbit(camera, x * turnSpeed, y * turnSpeed);
    } else if (doing === "pan") {
      this.stage.view.camera = pan(camera, x, y, viewport);
    } else if (doing === "hand" || doing === "tool" || event.shiftKey || this.leadsInPlane) {
      this.hand.move(x, y, 0);
    }
  }

  /** Says what a mouse without a button stands on, once it rests. */
  private point({ buttons, offsetX, offsetY, pointerType }: PointerEvent): void {
    if (buttons !== 0 || pointerType === "touch") {
      this.stage.pointed.leave();
      return;
    }
    this.stage.pointed.move(() => {
      const picked = this.stage.picker.at(offsetX, offsetY);
      return picked && this.readingOf(picked);
    });
  }

  /** Two fingers zoom about the place between them, and move the picture; in touch mode they turn it. */
  private lead(pair: PairMove | null): void {
    const { camera, content, viewport } = this.stage.view;
    if (pair === null || camera === null || content === null) {
      return;
    }
    const { x, y, spread, middle } = pair;
    const nearer = zoom(camera, 1 / spread, content);
    const grown = camera.distance / nearer.distance;
    this.stage.view.camera = this.hand.touchMode
      ? orbit(nearer, x * turnSpeed, y * turnSpeed)
      : pan(
          nearer,
          x + (1 - grown) * (middle[0] - viewport.width / 2),
          y + (1 - grown) * (middle[1] - viewport.height / 2),
          viewport,
        );
  }

  /** Whether the next click has a meaning of its own. */
  private get waitsForClick(): boolean {
    return this.stage.marks.placing !== null || this.stage.growing.armed;
  }

  /** Whether every move of the mouse moves the hand in the view plane. */
  private get leadsInPlane(): boolean {
    return this.hand.touchMode && !this.touching.ready;
  }

  private release(event: PointerEvent): void {
    this.fingers.lift(event.pointerId);
    if (this.drag === "grow" && event.type === "pointerup") {
      this.stage.growing.release();
    }
    this.finish(event);
    if (this.canvas.hasPointerCapture(event.pointerId)) {
      this.canvas.releasePointerCapture(event.pointerId);
    }
  }

  /** The page is left: nothing is pressed any more. */
  private leave(): void {
    if (this.drag === "touch") {
      this.drag = null;
      this.touching.lift();
      this.tool.release();
    }
  }

  /** Ends what the button began. */
  private finish(event: PointerEvent): void {
    const { stereo } = this.stage;
    const eye = stereo.at(event.offsetX, event.offsetY);
    this.leave();
    if (this.drag === "grow") {
      this.stage.growing.leave();
    } else if (this.drag === "tool") {
      this.tool.release();
    } else if (this.drag === "cut" && eye !== null) {
      armedLine(this.stage)?.finish(eye.camera, eye.viewport);
    }
    this.drag = null;
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
      this.drag === "touch" ||
      (this.drag === null && this.touching.ready && !event.shiftKey && !event.ctrlKey)
    ) {
      this.hand.mouse.turn(turned, event.offsetX, event.offsetY);
      this.touching.repeat();
    } else if (
      this.drag === "hand" ||
      this.drag === "tool" ||
      event.shiftKey ||
      (this.leadsInPlane && this.drag === null && !event.ctrlKey)
    ) {
      this.hand.move(0, 0, -turned * depthSpeed);
    } else if (camera !== null && content !== null) {
      this.stage.view.camera = zoom(camera, Math.exp(turned * zoomSpeed), content);
    }
  }

  /** Grows a region from what is seen there; says whether something is. */
  private grow(event: PointerEvent): boolean {
    const picked = this.stage.picker.at(event.offsetX, event.offsetY);
    const { camera } = this.stage.view;
    if (picked === null || camera === null) {
      return false;
    }
    this.stage.growing.press(addScaled(picked.point, camera.back, -growDepth));
    return true;
  }

  /** Says what is seen there, or sets a point of a mark on it. */
  private click(event: MouseEvent): void {
    if (event.detail > 1) {
      return;
    }
    const { marks, readout } = this.stage;
    this.marked = this.pressed !== null && marks.placing !== null;
    if (this.pressed === null) {
      return;
    }
    this.pressed = null;
    const picked = this.stage.picker.at(event.offsetX, event.offsetY);
    if (picked === null) {
      readout.close();
    } else if (this.marked) {
      marks.put(picked.point);
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
    if (armedLine(this.stage) !== null || this.marked) {
      return;
    }
    if (this.touching.ready || (this.tool.kind !== "none" && event.shiftKey)) {
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
