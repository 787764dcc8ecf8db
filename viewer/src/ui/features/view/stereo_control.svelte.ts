/**
 * Stereo as a person has chosen it, and what each eye sees of the 3-D view; remembered.
 */
import type { Camera, Viewport } from "../../../core/geometry/camera";
import type { Rect } from "../../../core/view/picture_layout";
import {
  eyeCamera,
  eyesOf,
  firstStereo,
  pointedEye,
  saneStereo,
  stereoModes,
  viewportOf,
  type EyePlace,
  type ShownEye,
  type Stereo,
} from "../../../core/view/stereo";
import { recall, remember } from "../../state/remembered";

export class StereoControl {
  choice = $state.raw<Stereo>(saneStereo(recall("stereo", firstStereo)));

  constructor(
    private readonly camera: () => Camera | null,
    private readonly pane: () => Rect,
  ) {}

  /** What is seen, by one eye or by two; nothing before there is a view. */
  readonly eyes = $derived.by((): readonly ShownEye[] =>
    eyesOf(this.choice, this.pane()).flatMap((place) => this.shown(place) ?? []),
  );

  choose(part: Partial<Stereo>): void {
    this.choice = { ...this.choice, ...part };
    remember("stereo", this.choice);
  }

  next(): void {
    const { mode } = this.choice;
    this.choose({ mode: stereoModes[(stereoModes.indexOf(mode) + 1) % stereoModes.length] ?? "off" });
  }

  /** Size of what an eye sees in a pane [CSS pixels]. */
  viewport(pane: Viewport): Viewport {
    return viewportOf(this.choice, pane);
  }

  /** The eye that is pointed at through a place of the pane, and the place in what it sees [CSS pixels]. */
  at(x: number, y: number): (ShownEye & { readonly place: readonly [number, number] }) | null {
    const eye = this.shown(pointedEye(this.choice, this.pane(), x, y));
    return eye && { ...eye, place: [(x - eye.rect.x) * eye.stretch[0], (y - eye.rect.y) * eye.stretch[1]] };
  }

  private shown({ aside, rect }: EyePlace): ShownEye | null {
    const camera = this.camera();
    const viewport = this.viewport(this.pane());
    const stretch = [viewport.width / rect.width, viewport.height / rect.height] as const;
    return camera && { camera: eyeCamera(camera, aside), viewport, rect, stretch };
  }
}
