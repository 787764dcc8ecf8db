/**
 * How the scan is shown in the 3-D view: what a person has chosen of it, remembered for each scan.
 */
import { defaultAppearance, transferFunctionOf, type Anchors, type Appearance } from "../core/appearance";
import { valueAbove } from "../core/histogram";
import type { Look } from "../core/look";
import { firstChoice, isGrey, opticsOf, usesTransferFunction, type OpticsChoice } from "../core/optics";
import type { Scan } from "../core/protocol";
import { draggedWindow, type WindowLevel } from "../core/window_level";
import { recall, remember } from "./remembered";

/** A boundary at full strength changes by this share of the soft-tissue-to-bone span per mm. */
const edgeShare = 0.2;

/** Share of the voxels that may be brighter than white in a MIP. */
const fewVoxels = 2e-4;

export class LookControl {
  appearance = $state.raw<Appearance | null>(null);
  choice = $state.raw<OpticsChoice | null>(null);
  private anchors = $state.raw<Anchors>({ softTissue: 0, bone: 1 });
  private brightest = 1;
  private scanName = "";

  /** Takes up a scan: as it was shown last, else as fits it. */
  open(scan: Scan): void {
    this.scanName = scan.name;
    this.anchors = { softTissue: scan.soft_tissue, bone: scan.bone };
    this.appearance = recall(`appearance.${scan.name}`, defaultAppearance(this.anchors));
    this.brightest = valueAbove(scan.histogram, fewVoxels);
    this.choice = recall(`optics.${scan.name}`, firstChoice(this.anchors, this.brightest));
  }

  /** All of the look but the segments; null before there is a scan. */
  readonly parts = $derived.by((): Omit<Look, "ranges"> | null => {
    const { appearance, choice, anchors } = this;
    return appearance === null || choice === null
      ? null
      : {
          transferFunction: transferFunctionOf(appearance),
          edgeGradient: edgeShare * Math.abs(appearance.window),
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

  choose(part: Partial<OpticsChoice>): void {
    if (this.choice !== null) {
      this.choice = { ...this.choice, ...part };
      remember(`optics.${this.scanName}`, this.choice);
    }
  }

  setWindow(window: WindowLevel): void {
    const { choice } = this;
    if (choice !== null && isGrey(choice.blend)) {
      this.choose({ windows: { ...choice.windows, [choice.blend]: window } });
    }
  }

  /** Back to what fits the scan; the mode stays. */
  reset(): void {
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
    } else if (usesTransferFunction(choice.blend)) {
      this.change(draggedWindow(appearance, right, down));
    } else {
      this.choose({ isoValue: choice.isoValue + (down * (this.anchors.bone - this.anchors.softTissue)) / 100 });
    }
  }
}
