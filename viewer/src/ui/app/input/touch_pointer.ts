/**
 * The pointer as a finger on what is drawn: pressed it brings the probe onto the surface under it, moved it slides the
 * probe along, lifted it lifts the hand off.
 */
import { rayThrough, type Ray } from "../../../core/geometry/camera";
import { addScaled } from "../../../core/geometry/vector";
import { keptSpan } from "../../../core/view/clip";
import type { HandControl } from "../../features/touch/hand_control.svelte";
import { strongest, weakest } from "../../features/touch/mouse_touch.svelte";
import type { Session } from "../../state/session.svelte";
import type { Stage } from "../stage";

/** The device that the mouse leads; another one is led by a person's own hand. */
const ledByMouse = "simulated";

export class TouchPointer {
  /** How the finger was moved last, while it presses. */
  private last: PointerEvent | null = null;

  constructor(
    private readonly session: Session,
    private readonly stage: Stage,
    private readonly hand: HandControl,
  ) {}

  /** Whether the left button touches what it is pressed on. */
  get ready(): boolean {
    const { touchMode, mouse } = this.hand;
    return touchMode && mouse.way === "surface" && this.session.device === ledByMouse && !this.stage.objects.holds;
  }

  /** Presses on what is drawn there; false where nothing is. */
  press(event: PointerEvent): boolean {
    if (this.stage.picker.at(event.offsetX, event.offsetY) === null) {
      return false;
    }
    this.move(event);
    return true;
  }

  /** The finger is there now. */
  move(event: PointerEvent): void {
    const { offsetX: x, offsetY: y } = event;
    const ray = this.rayAt(x, y);
    this.last = event;
    if (ray !== null) {
      this.hand.mouse.show({ x, y, presses: true });
      this.hand.press(ray, this.pressureOf(event));
    }
  }

  /** Presses on where it is with another pressure. */
  repeat(): void {
    if (this.last !== null) {
      this.move(this.last);
    }
  }

  /** Takes the finger off. */
  lift(): void {
    this.last = null;
    this.hand.mouse.show(null);
    this.hand.lift();
  }

  /** A pen says how hard it is pressed itself: up to what the wheel has set. */
  private pressureOf({ pointerType, pressure }: PointerEvent): number {
    const full = this.hand.mouse.pressure;
    return pointerType === "pen" ? Math.min(strongest, Math.max(weakest, full * pressure)) : full;
  }

  /** The eye's ray from where nothing is cut away. */
  private rayAt(x: number, y: number): Ray | null {
    const eye = this.stage.stereo.at(x, y);
    if (eye === null) {
      return null;
    }
    const ray = rayThrough(eye.camera, ...eye.place, eye.viewport);
    const [enter, leave] = keptSpan(this.stage.clips.cutting, ray);
    return enter < leave ? { ...ray, origin: addScaled(ray.origin, ray.direction, enter) } : null;
  }
}
