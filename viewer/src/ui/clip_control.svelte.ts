/**
 * What of the picture is cut away, as a person has chosen it; remembered for each scan. Every change is one
 * step of the page's own history, a whole drag too.
 */
import type { Camera } from "../core/camera";
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
} from "../core/clip";
import { advance, back, begin, forth, type History } from "../core/history";
import type { ScanFrame } from "../core/scan_volume";
import type { PageSteps } from "./page_steps.svelte";
import { recall, remember } from "./remembered";

export class ClipControl {
  private history = $state.raw<History<Clip>>(begin(nothingClipped));
  /** As it was before a drag began. */
  private dragged: Clip | null = null;
  frame = $state.raw<ScanFrame | null>(null);
  private scanName = "";

  constructor(private readonly steps: PageSteps) {}

  get clip(): Clip {
    return this.history.now;
  }

  /** Takes up a scan: cut as it was last. */
  open(scanName: string, frame: ScanFrame): void {
    this.scanName = scanName;
    this.frame = frame;
    this.dragged = null;
    this.history = begin(saneClip(recall(`clip.${scanName}`, nothingClipped), frame));
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

  /** Puts a face of a box so far inside of the scan [mm], until it is let go. */
  cut(face: Face, millimetres: number, box: ClipBox = this.clip.box): void {
    if (this.frame !== null) {
      this.drag({ box: withCut(box, this.frame, face, millimetres) });
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

  /** Puts a plane elsewhere along its normal [mm], until it is let go. */
  movePlane(place: number, offset: number): void {
    this.drag({ planes: this.withPlane(place, { offset }) });
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

  /** What was dragged is let go: all of it is one step. */
  drop(): void {
    const { clip, dragged } = this;
    if (dragged !== null) {
      this.take({ ...this.history, now: dragged });
      this.change(clip);
    }
  }

  undo(): void {
    this.take(back(this.history));
  }

  redo(): void {
    this.take(forth(this.history));
  }

  private withPlane(place: number, part: Partial<FreePlane>): readonly FreePlane[] {
    return this.clip.planes.map((plane, i) => (i === place ? { ...plane, ...part } : plane));
  }

  private drag(part: Partial<Clip>): void {
    const before = this.dragged ?? this.clip;
    this.take({ ...this.history, now: { ...this.clip, ...part } });
    this.dragged = before;
  }

  private change(part: Partial<Clip>): void {
    this.drop();
    const next = { ...this.clip, ...part };
    if (JSON.stringify(next) !== JSON.stringify(this.clip)) {
      this.take(advance(this.history, next));
      this.steps.add(this);
    }
  }

  private take(history: History<Clip>): void {
    this.dragged = null;
    this.history = history;
    remember(`clip.${this.scanName}`, history.now);
  }
}
