/**
 * How the scan is shown in the 3-D view: what a person has chosen of it, kept with the scan. Every change is a
 * step of undo, a whole drag too.
 */
import {
  defaultSoftTissueAndBone,
  transferFunctionOf,
  type Anchors,
  type SoftTissueAndBone,
} from "../../../core/appearance/soft_tissue_and_bone";
import {
  curveOfFunction,
  isCurve,
  placedCurve,
  transferFunctionOfCurve,
  type Curve,
} from "../../../core/appearance/curve";
import { curveOfPreset, presets } from "../../../core/appearance/curve_presets";
import { looks } from "../../../core/appearance/looks";
import { valueAbove } from "../../../core/scan/histogram";
import { firstLighting, type Lighting, type Appearance } from "../../../core/appearance/appearance";
import {
  blends,
  drawsSolids,
  firstChoice,
  isGrey,
  opticsOf,
  usesTransferFunction,
  type OpticsChoice,
} from "../../../core/appearance/optics";
import type { UnfeltChoice } from "../../../core/appearance/felt_look";
import type { Scan } from "../../../core/protocol";
import type { InsideMode, InsideModes } from "../../../core/segments/shown_segments";
import { readSlicerPreset } from "../../../core/appearance/slicer_preset";
import { draggedWindow, type WindowLevel } from "../../../core/appearance/window_level";
import { PageState } from "../../state/page_state.svelte";
import type { PageSteps } from "../../state/page_steps.svelte";
import type { ScanMemory } from "../../state/scan_memory";

const { edgeShare } = looks.tissue;

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

const noInside: InsideModes = {};

const firstUnfelt: UnfeltChoice = { hidden: false };

const firstCurve: CurveChoice = { name: anatomy, curve: null, shift: 0, stretch: 1 };

const { fewVoxels } = looks.modes;

/** How far a function is stretched, at most. */
export const mostStretch = 5;

/** Says after a preset's name that its points were changed. */
const ownMark = " *";

/** All that is chosen, each part under the name that it is kept by. */
interface ChosenAppearance {
  readonly appearance: SoftTissueAndBone;
  readonly optics: OpticsChoice;
  readonly curve: CurveChoice;
  readonly lighting: Lighting;
  readonly inside: InsideModes;
  readonly unfelt: UnfeltChoice;
}

/** What of the optics is changed, as a step of undo says it. @texts */
const opticsNames: Readonly<Record<keyof OpticsChoice, string>> = {
  blend: "mode",
  densities: "density",
  windows: "window and level",
  slabs: "slab",
  isoValue: "iso-value",
};

export class AppearanceControl {
  private readonly state: PageState<ChosenAppearance | null>;
  private anchors = $state.raw<Anchors>({ softTissue: 0, bone: 1 });
  private brightest = 1;
  private lowest = 0;

  constructor(
    steps: PageSteps,
    private readonly memory: ScanMemory,
  ) {
    this.state = new PageState<ChosenAppearance | null>(null, steps, this.keep.bind(this));
    memory.onChange((name) => {
      const { now } = this.state;
      if (now !== null && name in now) {
        this.state.take({ ...now, [name]: this.kept()[name as keyof ChosenAppearance] });
      }
    });
  }

  // derived, so that a change of one part is none of the others
  readonly softTissueAndBone = $derived.by((): SoftTissueAndBone | null => this.state.now?.appearance ?? null);
  readonly choice = $derived.by((): OpticsChoice | null => this.state.now?.optics ?? null);
  /** The transfer function by points. */
  readonly curveChoice = $derived.by((): CurveChoice => this.state.now?.curve ?? firstCurve);
  readonly lighting = $derived.by((): Lighting => this.state.now?.lighting ?? firstLighting);
  /** How each segment's voxels look inside the volume. */
  readonly inside = $derived.by((): InsideModes => this.state.now?.inside ?? noInside);
  /** Whether what cannot be touched is shown; in modes without solid bodies it always is. */
  readonly unfelt = $derived.by((): UnfeltChoice => {
    const { now } = this.state;
    return now !== null && drawsSolids(now.optics.blend) ? now.unfelt : firstUnfelt;
  });

  /** Takes up a scan: as it was shown last, else as fits it. */
  open(scan: Scan): void {
    this.anchors = { softTissue: scan.soft_tissue, bone: scan.bone };
    this.lowest = scan.range[0];
    this.brightest = valueAbove(scan.histogram, fewVoxels);
    this.state.open(this.kept());
  }

  /** As it is kept, else as fits the scan. */
  private kept(): ChosenAppearance {
    const { memory } = this;
    const curve = memory.recall("curve", firstCurve);
    const sane = curve.curve === null || (isCurve(curve.curve) && Number.isFinite(curve.shift) && curve.stretch > 0);
    const first = firstChoice(this.anchors, this.brightest);
    const optics = memory.recall("optics", first);
    return {
      appearance: memory.recall("appearance", defaultSoftTissueAndBone(this.anchors)),
      optics: blends.includes(optics.blend) ? optics : first,
      curve: sane ? curve : firstCurve,
      lighting: memory.recall("lighting", firstLighting),
      inside: memory.recall("inside", noInside),
      unfelt: memory.recall("unfelt", firstUnfelt),
    };
  }

  /** The points as they stand among the scan's values; null where sliders make the function. */
  readonly curve = $derived.by((): Curve | null => {
    const { curve, shift, stretch } = this.curveChoice;
    return curve === null ? null : placedCurve(curve, shift, stretch);
  });

  /** Points that say what the sliders make. */
  readonly shownCurve = $derived.by((): Curve | null => {
    const { softTissueAndBone, curve } = this;
    return curve ?? (softTissueAndBone === null ? null : curveOfFunction(transferFunctionOf(softTissueAndBone)));
  });

  /** All of the appearance but the segments; null before there is a scan. */
  readonly parts = $derived.by((): Omit<Appearance, "ranges"> | null => {
    const { softTissueAndBone, choice, anchors } = this;
    return softTissueAndBone === null || choice === null
      ? null
      : {
          transferFunction:
            this.curve === null ? transferFunctionOf(softTissueAndBone) : transferFunctionOfCurve(this.curve),
          edgeGradient:
            edgeShare * Math.abs(this.curve === null ? softTissueAndBone.window : anchors.bone - anchors.softTissue),
          lighting: this.lighting,
          optics: opticsOf(choice, anchors),
        };
  });

  /** Window and level of the mode of grey that is on. */
  readonly window = $derived.by((): WindowLevel | null => {
    const { choice } = this;
    return choice !== null && isGrey(choice.blend) ? choice.windows[choice.blend] : null;
  });

  /** Sliders of tissue, or a drag in the picture. */
  change(part: Partial<SoftTissueAndBone>): void {
    if (this.softTissueAndBone !== null) {
      this.set("tissue", { appearance: { ...this.softTissueAndBone, ...part } }, true);
    }
  }

  /** Another transfer function: one step of undo; while something is dragged, a part of one. */
  draw(part: Partial<CurveChoice>, dragging = false): void {
    this.set("transfer function", { curve: { ...this.curveChoice, ...part } }, dragging);
  }

  /** Other points, as they stand among the scan's values. */
  drawPoints(curve: Curve, dragging: boolean): void {
    const { name } = this.curveChoice;
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
    return this.softTissueAndBone === null ? null : curveOfFunction(transferFunctionOf(this.softTissueAndBone));
  }

  /** Another way to draw; all of it but the mode has sliders. */
  choose<Key extends keyof OpticsChoice>(key: Key, value: OpticsChoice[Key]): void {
    if (this.choice !== null) {
      this.set(opticsNames[key], { optics: { ...this.choice, [key]: value } }, key !== "blend");
    }
  }

  /** Sliders of the light. */
  light(part: Partial<Lighting>): void {
    this.set("lighting", { lighting: { ...this.lighting, ...part } }, true);
  }

  /** How a segment's voxels look inside the volume. */
  setInside(id: number, mode: InsideMode): void {
    this.set("look inside the volume", { inside: { ...this.inside, [id]: mode } });
  }

  /** Shows what cannot be touched, or hides it. */
  showUnfelt(shown: boolean): void {
    this.set("display of what cannot be touched", { unfelt: { hidden: !shown } });
  }

  setWindow(window: WindowLevel): void {
    const { choice } = this;
    if (choice !== null && isGrey(choice.blend)) {
      this.choose("windows", { ...choice.windows, [choice.blend]: window });
    }
  }

  /** Back to what fits the scan, and to the first mode. */
  reset(): void {
    this.set("reset of the look", {
      appearance: defaultSoftTissueAndBone(this.anchors),
      optics: firstChoice(this.anchors, this.brightest),
      curve: firstCurve,
      lighting: firstLighting,
      unfelt: firstUnfelt,
    });
  }

  /** A drag in the 3-D view [pixels]: to the right wider, upward brighter, as in slices. */
  drag(right: number, down: number): void {
    const { softTissueAndBone, choice, window } = this;
    if (choice === null || softTissueAndBone === null) {
      return;
    }
    if (window !== null) {
      this.setWindow(draggedWindow(window, right, down));
    } else if (usesTransferFunction(choice.blend) && this.curve !== null) {
      const { shift, stretch } = this.curveChoice;
      const perPixel = (this.anchors.bone - this.anchors.softTissue) / 100;
      const stretched = Math.min(mostStretch, Math.max(1 / mostStretch, stretch * Math.exp(right / 300)));
      this.draw({ shift: shift + down * perPixel, stretch: stretched }, true);
    } else if (usesTransferFunction(choice.blend)) {
      this.change(draggedWindow(softTissueAndBone, right, down));
    } else {
      this.choose("isoValue", choice.isoValue + (down * (this.anchors.bone - this.anchors.softTissue)) / 100);
    }
  }

  private set(name: string, part: Partial<ChosenAppearance>, dragging = false): void {
    const { now } = this.state;
    if (now !== null) {
      this.state.change(name, { ...now, ...part }, dragging);
    }
  }

  /** Keeps what is another than before. */
  private keep(appearance: ChosenAppearance | null, before: ChosenAppearance | null): void {
    for (const [name, part] of Object.entries(appearance ?? {}) as [keyof ChosenAppearance, object][]) {
      if (part !== before?.[name]) {
        this.memory.keep(name, part);
      }
    }
  }
}
