/**
 * What of the picture is cut away, as a person has chosen it; remembered for each scan.
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
import type { ScanFrame } from "../core/scan_volume";
import { recall, remember } from "./remembered";

export class ClipControl {
  clip = $state.raw<Clip>(nothingClipped);
  frame = $state.raw<ScanFrame | null>(null);
  private scanName = "";

  /** Takes up a scan: cut as it was last. */
  open(scanName: string, frame: ScanFrame): void {
    this.scanName = scanName;
    this.frame = frame;
    this.clip = saneClip(recall(`clip.${scanName}`, nothingClipped), frame);
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

  /** Puts a face of a box so far inside of the scan [mm]. */
  cut(face: Face, millimetres: number, box: ClipBox = this.clip.box): void {
    if (this.frame !== null) {
      this.change({ box: withCut(box, this.frame, face, millimetres) });
    }
  }

  /** Adds a plane through the middle of the view, which cuts away what stands before it. */
  addPlane(camera: Camera): void {
    if (!this.full) {
      this.change({ planes: [...this.clip.planes, planeAcross(camera)] });
    }
  }

  changePlane(place: number, part: Partial<FreePlane>): void {
    this.change({ planes: this.clip.planes.map((plane, i) => (i === place ? { ...plane, ...part } : plane)) });
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

  private change(part: Partial<Clip>): void {
    this.clip = { ...this.clip, ...part };
    remember(`clip.${this.scanName}`, this.clip);
  }
}
