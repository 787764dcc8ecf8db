/**
 * Passes slices, clip planes, marks, the second scan and how fine all is drawn to the picture as they change, and
 * knows whether it has them.
 */
import type { Plane } from "../../core/view/clip";
import type { QualityChoice } from "../../core/view/quality";
import type { CutSheet } from "../../core/segments/cut_sheet";
import type { Vec3 } from "../../core/geometry/vector";
import type { Picture } from "../../gl/picture/picture";
import type { ShownSecond } from "../../gl/textures/second_texture";
import type { ShownSlice, SliceAppearance } from "../../gl/picture/slices";
import type { ClipControl } from "../features/view/clip_control.svelte";
import type { CutControl } from "../features/segments/cut_control.svelte";
import type { MarkControl } from "../features/marks/mark_control.svelte";
import type { QualityControl } from "../features/view/quality_control.svelte";
import type { SecondControl } from "../features/second/second_control.svelte";
import type { SliceControl } from "../features/slices/slice_control.svelte";

/** Between two drawings of slices where the CPU draws [ms]. */
const slicePause = 25;

/** Controls whose state is passed on. */
export interface SyncedControls {
  readonly slices: SliceControl;
  readonly quality: QualityControl;
  readonly clips: ClipControl;
  readonly marks: MarkControl;
  readonly cutting: CutControl;
  readonly second: SecondControl;
}

export class PictureSync {
  private quality: QualityChoice | null = null;
  private clip: readonly Plane[] | null = null;
  private marks: readonly (readonly Vec3[])[] | null = null;
  private sheet: CutSheet | null = null;
  private slices: readonly ShownSlice[] | null = null;
  private sliceAppearance: SliceAppearance | null = null;
  private second: ShownSecond | null = null;
  private slicesAt = 0;

  /** @param software whether the CPU draws. */
  constructor(
    private readonly controls: SyncedControls,
    private readonly software: boolean,
  ) {}

  /** A new picture has nothing yet. */
  forget(): void {
    this.quality = null;
    this.clip = null;
    this.marks = null;
    this.sheet = null;
    this.slices = null;
    this.sliceAppearance = null;
    this.second = null;
  }

  /** Whether the picture has all that is to be seen. */
  get isWhole(): boolean {
    const { clips, cutting, marks, quality, second, slices } = this.controls;
    const sliced = slices.shown === this.slices && slices.appearance === this.sliceAppearance;
    return (
      sliced &&
      quality.choice === this.quality &&
      clips.cutting === this.clip &&
      marks.lines === this.marks &&
      cutting.sheet === this.sheet &&
      second.shown === this.second &&
      second.progress === null
    );
  }

  /** @param scan whether the picture has the first scan: it tells in which form values go to the GPU. */
  pass(picture: Picture, now: number, scan: boolean): void {
    this.passSlices(picture, now);
    const { clips, cutting, marks, quality, second } = this.controls;
    if (quality.choice !== this.quality) {
      this.quality = quality.choice;
      picture.setQuality(this.quality);
    }
    if (clips.cutting !== this.clip) {
      this.clip = clips.cutting;
      picture.contents.setClip(this.clip);
    }
    if (marks.lines !== this.marks) {
      this.marks = marks.lines;
      picture.contents.setMarks(this.marks);
    }
    if (cutting.sheet !== this.sheet) {
      this.sheet = cutting.sheet;
      picture.contents.setCutSheet(this.sheet);
    }
    if (scan && second.shown !== this.second) {
      this.second = second.shown;
      picture.contents.setSecond(this.second);
    }
  }

  /** Slices: without a graphics card less often, so that touch stays fluent. */
  private passSlices(picture: Picture, now: number): void {
    if (this.software && now - this.slicesAt < slicePause) {
      return;
    }
    const { shown, appearance } = this.controls.slices;
    this.slicesAt = now;
    if (appearance !== this.sliceAppearance) {
      this.sliceAppearance = appearance;
      picture.contents.setSliceAppearance(appearance);
    }
    if (shown !== this.slices) {
      this.slices = shown;
      picture.contents.setSlices(shown);
    }
  }
}
