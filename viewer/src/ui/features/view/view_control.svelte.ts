/**
 * The view of the 3-D picture: where it is seen from, in which projection, and what of it fills the pane.
 */
import type { Letter } from "../../../core/geometry/anatomy";
import {
  firstView,
  frame,
  inProjection,
  lookFrom,
  orbit,
  pan,
  reshaped,
  sameView,
  zoom,
  type Camera,
  type Extent,
  type Viewport,
} from "../../../core/geometry/camera";
import type { Vec3 } from "../../../core/geometry/vector";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";

export class ViewControl {
  camera = $state.raw<Camera | null>(null);
  /** Size of what is seen in the 3-D view's pane, by each eye where there are two [CSS pixels]. */
  viewport = $state.raw<Viewport>({ width: 1, height: 1 });
  /** Size of what is shown; null before there is a scan. */
  content: Extent | null = null;

  private sentCamera: Camera | null = null;
  private sentTo = 0;

  constructor(private readonly session: Session) {}

  lookFrom(letter: Letter): void {
    this.camera = this.content && this.projected(lookFrom(letter, this.content, this.viewport), this.content);
  }

  reset(): void {
    this.camera = this.content && this.projected(firstView(this.content, this.viewport), this.content);
  }

  frameAll(): void {
    this.camera = this.content && this.camera && frame(this.camera, this.content, this.viewport);
  }

  /** Turns the picture as if its content were dragged by these angles [rad]. */
  turn(horizontal: number, vertical: number): void {
    this.camera = this.camera && orbit(this.camera, horizontal, vertical);
  }

  /** Moves the picture's content [CSS pixels]. */
  move(x: number, y: number): void {
    this.camera = this.camera && pan(this.camera, x, y, this.viewport);
  }

  /** Comes nearer (`factor` < 1) or goes away. */
  approach(factor: number): void {
    this.camera = this.content && this.camera && zoom(this.camera, factor, this.content);
  }

  /** Moves the picture so that a point is in its middle. */
  centreOn(point: Vec3): void {
    this.camera = this.camera && { ...this.camera, target: point };
  }

  /** Whether things look as large however far away they are. */
  get orthographic(): boolean {
    return this.camera === null
      ? recall("projection", { orthographic: false }).orthographic
      : this.camera.parallel !== null;
  }

  set orthographic(on: boolean) {
    remember("projection", { orthographic: on });
    this.camera = this.content && this.camera && inProjection(this.camera, on, this.content);
  }

  /** Follows the size of the pane [CSS pixels]. */
  resize({ width, height }: Viewport): void {
    const before = this.viewport;
    if (width !== before.width || height !== before.height) {
      this.viewport = { width, height };
      this.camera = this.camera && reshaped(this.camera, before, this.viewport);
    }
  }

  /** Device moves follow the view's axes, so the engine must know them. */
  tell(): void {
    const { camera, session } = this;
    if (
      camera !== null &&
      (this.sentCamera === null || this.sentTo !== session.greetings || !sameView(camera, this.sentCamera))
    ) {
      this.sentCamera = camera;
      this.sentTo = session.greetings;
      session.send({ type: "view", right: camera.right, up: camera.up });
    }
  }

  /** A view of all in the projection that was chosen. */
  private projected(camera: Camera, extent: Extent): Camera {
    return this.orthographic ? frame(inProjection(camera, true, extent), extent, this.viewport) : camera;
  }
}
