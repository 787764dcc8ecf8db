/**
 * How the scan is shown in the 3-D view: what a person has chosen of it, remembered for each scan.
 */
import { defaultAppearance, transferFunctionOf, type Anchors, type Appearance } from "../core/appearance";
import { curveOfFunction, isCurve, placedCurve, transferFunctionOfCurve, type Curve } from "../core/curve";
import { curveOfPreset, presets } from "../core/curve_presets";
import { advance, back, begin, forth, type History } from "../core/history";
import { valueAbove } from "../core/histogram";
import { firstLighting, type Lighting, type Look } from "../core/look";
import { blends, firstChoice, isGrey, opticsOf, usesTransferFunction, type OpticsChoice } from "../core/optics";
import type { Scan } from "../core/protocol";
import type { InsideMode, InsideModes } from "../core/shown_segments";
import { readSlicerPreset } from "../core/slicer_preset";
import { draggedWindow, type WindowLevel } from "../core/window_level";
import { recall, remember } from "./remembered";

/** A boundary at full strength changes by this share of the soft-tissue-to-bone span per mm. */
const edgeShare = 0.2;

/** A transfer function by points, as it stands; null where sliders of tissue and bone make it. */
export interface CurveChoice {
  readonly name: string;
  readonly curve: Curve | null;
  /** Moves it along the values, in their unit, and stretches it about its middle. */
  readonly shift: number;
  readonly stretch: number;
}

/** The name of the function that sliders make. */
export const anatomy = "Bone in tissue";

const firstCurve: CurveChoice = { name: anatomy, curve: null, shift: 0, stretch: 1 };

/** Share of the voxels that may be brighter than white in a MIP. */
const fewVoxels = 2e-4;

/** How far a function is stretched, at most. */
export const mostStretch = 5;

/** Says after a preset's name that its points were changed. */
const ownMark = " *";

export class LookControl {
  appearance = $state.raw<Appearance | null>(null);
  choice = $state.raw<OpticsChoice | null>(null);
  /** The transfer function by points, with what can be taken back. */
  curves = $state.raw<History<CurveChoice>>(begin(firstCurve));
  private anchors = $state.raw<Anchors>({ softTissue: 0, bone: 1 });
  private brightest = 1;
  private scanName = "";

  lighting = $state.raw<Lighting>(firstLighting);
  /** How each segment's voxels look inside the volume. */
  inside = $state.raw<InsideModes>({});
  /** The function as it was before a drag began: a drag is one step. */
  private dragged: CurveChoice | null = null;
  private lowest = 0;

  /** Takes up a scan: as it was shown last, else as fits it. */
  open(scan: Scan): void {
    this.scanName = scan.name;
    this.anchors = { softTissue: scan.soft_tissue, bone: scan.bone };
    this.appearance = recall(`appearance.${scan.name}`, defaultAppearance(this.anchors));
    this.lowest = scan.range[0];
    const kept = recall(`curve.${scan.name}`, firstCurve);
    const sane = kept.curve === null || (isCurve(kept.curve) && Number.isFinite(kept.shift) && kept.stretch > 0);
    this.curves = begin(sane ? kept : firstCurve);
    this.lighting = recall(`lighting.${scan.name}`, firstLighting);
    this.inside = recall(`inside.${scan.name}`, {});
    this.brightest = valueAbove(scan.histogram, fewVoxels);
    const first = firstChoice(this.anchors, this.brightest);
    const choice = recall(`optics.${scan.name}`, first);
    this.choice = blends.includes(choice.blend) ? choice : first;
  }

  /** The points as they stand among the scan's values; null where sliders make the function. */
  readonly curve = $derived.by((): Curve | null => {
    const { curve, shift, stretch } = this.curves.now;
    return curve === null ? null : placedCurve(curve, shift, stretch);
  });

  /** Points that say what the sliders make. */
  readonly shownCurve = $derived.by((): Curve | null => {
    const { appearance, curve } = this;
    return curve ?? (appearance === null ? null : curveOfFunction(transferFunctionOf(appearance)));
  });

  /** All of the look but the segments; null before there is a scan. */
  readonly parts = $derived.by((): Omit<Look, "ranges"> | null => {
    const { appearance, choice, anchors } = this;
    return appearance === null || choice === null
      ? null
      : {
          transferFunction: this.curve === null ? transferFunctionOf(appearance) : transferFunctionOfCurve(this.curve),
          edgeGradient: edgeShare * Math.abs(this.curve === null ? appearance.window : anchors.bone - anchors.softTissue),
          lighting: this.lighting,
          optics: opticsOf(choice, anchors),
        };
  });

  /** Window and level of the mode of grey that is on. */
  readonly window = $derived.by((): WindowLevel | null => {
    const { choice } = this;
    return choice !== null && isGrey(choice.blend) ? choice.windows[choice.blend] : null;
  });

  change(part: Partial<Appearance>): void {
    if (this.appearance !== null) {
      this.appearance = { ...this.appearance, ...part };
      remember(`appearance.${this.scanName}`, this.appearance);
    }
  }

  /** Another transfer function: one step that can be taken back; while something is dragged, a part of one. */
  draw(part: Partial<CurveChoice>, dragging = false): void {
    const { now } = this.curves;
    const next = { ...now, ...part };
    if (dragging) {
      this.dragged ??= now;
      this.curves = { ...this.curves, now: next };
    } else {
      this.curves = advance({ ...this.curves, now: this.dragged ?? now }, next);
      this.dragged = null;
    }
    remember(`curve.${this.scanName}`, next);
  }

  /** Ends a drag: what it changed becomes one step. */
  drawn(): void {
    if (this.dragged !== null) {
      this.draw({});
    }
  }

  /** Other points, as they stand among the scan's values. */
  drawPoints(curve: Curve, dragging: boolean): void {
    const { name } = this.curves.now;
    const edited = name.endsWith(ownMark) ? name : `${name}${ownMark}`;
    this.draw({ name: edited, curve, shift: 0, stretch: 1 }, dragging);
  }

  /** A preset by its name, or the function that sliders make. */
  usePreset(name: string): void {
    const preset = presets.find((other) => other.name === name);
    const curve = preset === undefined ? null : curveOfPreset(preset, this.anchors, this.lowest, this.brightest);
    this.draw({ ...firstCurve, name: preset?.name ?? anatomy, curve });
  }

  /**
   * The function of a volume property of 3D Slicer, by its text.
   *
   * @throws where it is none.
   */
  useImported(text: string): void {
    this.draw({ ...firstCurve, ...readSlicerPreset(text) });
  }

  /** What a preset looks like on this scan; the sliders' function by its other name. */
  previewOf(name: string): Curve | null {
    const preset = presets.find((other) => other.name === name);
    if (preset !== undefined) {
      return curveOfPreset(preset, this.anchors, this.lowest, this.brightest);
    }
    return this.appearance === null ? null : curveOfFunction(transferFunctionOf(this.appearance));
  }

  undo(): void {
    this.go(back(this.curves));
  }

  redo(): void {
    this.go(forth(this.curves));
  }

  private go(history: History<CurveChoice>): void {
    this.dragged = null;
    this.curves = history;
    remember(`curve.${this.scanName}`, history.now);
  }

  choose(part: Partial<OpticsChoice>): void {
    if (this.choice !== null) {
      this.choice = { ...this.choice, ...part };
      remember(`optics.${this.scanName}`, this.choice);
    }
  }

  light(part: Partial<Lighting>): void {
    this.lighting = { ...this.lighting, ...part };
    remember(`lighting.${this.scanName}`, this.lighting);
  }

  /** How a segment's voxels look inside the volume. */
  setInside(id: number, mode: InsideMode): void {
    this.inside = { ...this.inside, [id]: mode };
    remember(`inside.${this.scanName}`, this.inside);
  }

  setWindow(window: WindowLevel): void {
    const { choice } = this;
    if (choice !== null && isGrey(choice.blend)) {
      this.choose({ windows: { ...choice.windows, [choice.blend]: window } });
    }
  }

  /** Back to what fits the scan; the mode stays. */
  reset(): void {
    this.usePreset(anatomy);
    this.light(firstLighting);
    this.change(defaultAppearance(this.anchors));
    this.choose({ ...firstChoice(this.anchors, this.brightest), blend: this.choice?.blend ?? "shaded" });
  }

  /** A drag in the 3-D view [pixels]: to the right wider, upward brighter, as in slices. */
  drag(right: number, down: number): void {
    const { appearance, choice, window } = this;
    if (choice === null || appearance === null) {
      return;
    }
    if (window !== null) {
      this.setWindow(draggedWindow(window, right, down));
    } else if (usesTransferFunction(choice.blend) && this.curve !== null) {
      const { shift, stretch } = this.curves.now;
      const perPixel = (this.anchors.bone - this.anchors.softTissue) / 100;
      const stretched = Math.min(mostStretch, Math.max(1 / mostStretch, stretch * Math.exp(right / 300)));
      this.draw({ shift: shift + down * perPixel, stretch: stretched }, true);
    } else if (usesTransferFunction(choice.blend)) {
      this.change(draggedWindow(appearance, right, down));
    } else {
      this.choose({ isoValue: choice.isoValue + (down * (this.anchors.bone - this.anchors.softTissue)) / 100 });
    }
  }
}
