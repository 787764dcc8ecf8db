/**
 * The mouse over the picture: turn, move, zoom, and the hand.
 *
 * Left drag turns, middle or Ctrl + left drag moves the picture, the wheel zooms. Right drag,
 * Shift + move, or any move in touch mode moves the hand in the view plane; meanwhile the
 * wheel moves it in depth. Alt + left drag changes window and level of what is seen. Where a region is to be grown,
 * a left click says from where. Where a segment is to be cut, the left button paints the line. With a tool chosen, the left button presses it wherever the mouse
 * moves the hand without a button. A double click brings the probe to what is seen there.
 */
import { orbit, pan, zoom } from "../core/camera";
import { addScaled } from "../core/vector";
import type { HandControl } from "./hand_control.svelte";
import type { Session } from "./session.svelte";
import type { Stage } from "./stage.svelte";
import type { ToolHand } from "./tool_hand.svelte";

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
/** A press that moves less is a click [pixels]. */
const clickWay = 4;

export class PointerInput {
  private drag: Drag | null = null;
  private last: readonly [number, number] | null = null;
  private pressed: readonly [number, number] = [0, 0];

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
      this.stage.cutting.begin([event.offsetX, event.offsetY]);
    } else if (event.button === 0) {
      this.drag = (event.shiftKey || this.hand.touchMode) && this.tool.press() ? "tool" : "orbit";
    }
    this.last = [event.clientX, event.clientY];
    this.pressed = this.last;
  }

  private move(event: PointerEvent): void {
    const [lastX, lastY] = this.last ?? [event.clientX, event.clientY];
    const x = event.clientX - lastX;
    const y = event.clientY - lastY;
    this.last = [event.clientX, event.clientY];
    const { camera, viewport } = this.stage;
    if (camera === null || (x === 0 && y === 0)) {
      return;
    }
    if (this.drag === "cut") {
      this.stage.cutting.paint([event.offsetX, event.offsetY]);
      return;
    }
    if (this.drag === "look") {
      this.stage.looks.drag(x, y);
      return;
    }
    const doing = this.drag === "orbit" && event.shiftKey ? "hand" : this.drag;
    if (doing === "orbit") {
      this.stage.camera = orbit(camera, x * turnSpeed, y * turnSpeed);
    } else if (doing === "pan") {
      this.stage.camera = pan(camera, x, y, viewport);
    } else if (doing === "hand" || doing === "tool" || event.shiftKey || this.hand.touchMode) {
      this.hand.move(x, y, 0);
    }
  }

  private release(event: PointerEvent): void {
    const { camera, cutting, viewport } = this.stage;
    if (this.drag === "look") {
      this.stage.looks.drawn();
    } else if (this.drag === "tool") {
      this.tool.release();
    } else if (this.drag === "cut" && camera !== null) {
      cutting.finish(camera, viewport);
    } else if (this.drag === "orbit" && this.stage.growing.armed && isClick(this.pressed, event)) {
      this.grow(event);
    }
    this.drag = null;
    if (this.canvas.hasPointerCapture(event.pointerId)) {
      this.canvas.releasePointerCapture(event.pointerId);
    }
  }

  private grow(event: PointerEvent): void {
    const picked = this.stage.pick(event.offsetX, event.offsetY);
    const { camera } = this.stage;
    if (picked === null || camera === null) {
      this.session.notify("info", "Nothing is drawn there: click on the scan, or in a slice.");
      return;
    }
    this.stage.growing.from(addScaled(picked.point, camera.back, -growDepth));
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const turned = wheelPixels(event);
    const { camera, content, objects } = this.stage;
    if (event.altKey && camera !== null && objects.holds) {
      objects.turn(camera.back, turned * turnSpeed * 0.1);
    } else if (this.drag === "hand" || this.drag === "tool" || event.shiftKey || (this.hand.touchMode && this.drag === null && !event.ctrlKey)) {
      this.hand.move(0, 0, -turned * depthSpeed);
    } else if (camera !== null && content !== null) {
      this.stage.camera = zoom(camera, Math.exp(turned * zoomSpeed), content);
    }
  }

  private bringProbe(event: MouseEvent): void {
    // two short strokes are no double click, nor are two short lines
    if (this.stage.cutting.id !== null) {
      return;
    }
    if (this.tool.kind !== "none" && (event.shiftKey || this.hand.touchMode)) {
      return;
    }
    const picked = this.stage.pick(event.offsetX, event.offsetY);
    const { camera } = this.stage;
    this.stage.name(picked);
    if (picked === null || camera === null) {
      this.session.notify("info", "Nothing is drawn there: double-click on the scan to bring the probe to it.");
      return;
    }
    this.hand.place(addScaled(picked.point, camera.back, standOff));
  }
}

/** Whether the mouse is let go where it was pressed. */
export function isClick(pressed: readonly [number, number], event: MouseEvent): boolean {
  return Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < clickWay;
}

/** Pixels of a wheel event, which may count lines or pages. */
export function wheelPixels(event: WheelEvent): number {
  // with Shift held some browsers turn the wheel into a sideways one
  const delta = event.deltaY === 0 ? event.deltaX : event.deltaY;
  const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : event.deltaMode === WheelEvent.DOM_DELTA_PAGE ? 400 : 1;
  return Math.max(-400, Math.min(400, delta * unit));
}
