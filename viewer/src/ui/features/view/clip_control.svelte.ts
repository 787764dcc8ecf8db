/**
 * What of the picture is cut away, as a person has chosen it; kept with the scan. Every change is one
 * step of the page's own history, a whole drag too.
 */
import type { Camera } from "../../../core/geometry/camera";
import {
  facesOf,
  flipped,
  mostFreePlanes,
  nothingClipped,
  planeAcross,
  planesOf,
  saneClip,
  withCut,
  type Clip,
  type ClipBox,
  type Face,
  type FreePlane,
  type Plane,
} from "../../../core/view/clip";
import type { ScanFrame } from "../../../core/scan/scan_volume";
import { PageState } from "../../state/page_state.svelte";
import type { PageSteps } from "../../state/page_steps.svelte";
import type { ScanMemory } from "../../state/scan_memory";

const part = "clip";

export class ClipControl {
  private readonly state: PageState<Clip>;
  frame = $state.raw<ScanFrame | null>(null);

  constructor(
    steps: PageSteps,
    private readonly memory: ScanMemory,
  ) {
    this.state = new PageState(nothingClipped, steps, (clip) => {
      memory.keep(part, clip);
    });
    memory.onChange((name) => {
      if (name === part && this.frame !== null) {
        this.state.take(this.kept(this.frame));
      }
    });
  }

  get clip(): Clip {
    return this.state.now;
  }

  /** Takes up a scan: cut as it was last. */
  open(frame: ScanFrame): void {
    this.frame = frame;
    this.state.open(this.kept(frame));
  }

  /** All planes that cut something away, in the scene. */
  readonly cutting = $derived.by((): readonly Plane[] => (this.frame === null ? [] : planesOf(this.clip, this.frame)));

  readonly faces = $derived.by((): readonly Face[] => (this.frame === null ? [] : facesOf(this.frame)));

  get full(): boolean {
    return this.clip.planes.length >= mostFreePlanes;
  }

  switchBox(on: boolean): void {
    this.change({ box: { ...this.clip.box, on } });
  }

  /** Puts a face of a box so far inside of the scan [mm], as long as it is dragged. */
  cut(face: Face, millimetres: number, box: ClipBox = this.clip.box): void {
    if (this.frame !== null) {
      this.change({ box: withCut(box, this.frame, face, millimetres) }, true);
    }
  }

  /** Adds a plane through the middle of the view, which cuts away what stands before it. */
  addPlane(camera: Camera): void {
    if (!this.full) {
      this.change({ planes: [...this.clip.planes, planeAcross(camera)] });
    }
  }

  switchPlane(place: number, on: boolean): void {
    this.change({ planes: this.withPlane(place, { on }) });
  }

  /** Puts a plane elsewhere along its normal [mm], as long as it is dragged. */
  movePlane(place: number, offset: number): void {
    this.change({ planes: this.withPlane(place, { offset }) }, true);
  }

  flip(place: number): void {
    this.change({ planes: this.clip.planes.map((plane, i) => (i === place ? flipped(plane) : plane)) });
  }

  remove(place: number): void {
    this.change({ planes: this.clip.planes.filter((_, i) => i !== place) });
  }

  /** Nothing is cut away any more. */
  reset(): void {
    this.change(nothingClipped);
  }

  private kept(frame: ScanFrame): Clip {
    return saneClip(this.memory.recall(part, nothingClipped), frame);
  }

  private withPlane(place: number, part: Partial<FreePlane>): readonly FreePlane[] {
    return this.clip.planes.map((plane, i) => (i === place ? { ...plane, ...part } : plane));
  }

  private change(part: Partial<Clip>, dragging = false): void {
    this.state.change("clipping", { ...this.clip, ...part }, dragging);
  }
}
