/**
 * What segments are made of and by which model they give way, as the page offers it: names, and
 * ranges of the controls. Moduli [Pa].
 */
import { afterNumber, capitalised } from "../base/format";
import { described, writtenConstants } from "./tissue_constants";
import type {
  Boxes, Constants, DeformationModel, ForceSource, MaterialPreset, Segment, SegmentMaterial,
} from "../protocol";

/** What the slider offers. */
export const offeredTissue = { young: { min: 500, max: 1e8 } } as const;

/** The model that is taken where a segment is made soft and none was chosen. */
export const usualModel = "lattice";

/** What can be felt of soft tissue. */
export const forceSources: readonly { readonly value: ForceSource; readonly name: string; readonly title: string }[] = [
  {
    value: "matter",
    name: "The model's",
    title: "The contact force of the model through the spring to the hand (thesis 5.16); usual",
  },
  {
    value: "voxels",
    name: "The border's",
    title:
      "Voxels are hard until the model has moved them away: the rigid border of thesis 5.23. A hand that stays " +
      "feels less and less",
  },
];

/** "Cortical bone", of "cortical-bone". */
export function presetName(preset: string): string {
  return capitalised(preset.replaceAll("-", " "));
}

/** "Thesis bone (by HU)": with what its constants follow. */
export function presetTitle({ name, needs_hounsfield }: MaterialPreset): string {
  return `${presetName(name)}${needs_hounsfield ? " (by HU)" : ""}`;
}

/** "5.50 kPa" */
export function formatModulus(pascal: number): string {
  const [unit, name] = (
    [
      [1e9, "GPa"],
      [1e6, "MPa"],
      [1e3, "kPa"],
    ] as const
  ).find(([size]) => pascal >= 0.9995 * size) ?? [1, "Pa"];
  return `${(pascal / unit).toPrecision(3)}${afterNumber(name)}`;
}

/** Constants that do not follow HU; null where they do. */
export function constantsOf({ low, high }: SegmentMaterial): Constants | null {
  const same = (Object.keys(low) as (keyof Constants)[]).every((name) => low[name] === high[name]);
  return same ? low : null;
}

/** "5.50 kPa, ν 0.45, 1.06 g/cm³, breaks at 34 %, friction 20 %"; from one to the other where they follow HU. */
export function describeMaterial({ low, high }: Pick<SegmentMaterial, "low" | "high">): string {
  return writtenConstants
    .map((constant) => {
      const [from = "", to] = new Set(
        [low, high].map((constants) =>
          constant.key === "young" ? formatModulus(constants.young) : described(constant, constants),
        ),
      );
      const range = to === undefined ? from : `${from} to ${to}`;
      return describedAs[constant.key](range);
    })
    .filter((part) => part !== null)
    .join(", ");
}

/** How a constant stands in a sentence with the others. */
const describedAs: Readonly<Record<keyof Constants, (range: string) => string | null>> = {
  young: (range) => range,
  poisson: (range) => `ν ${range}`,
  density: (range) => range,
  fracture_energy: (range) => (range === "never" ? "never tears" : `tears at ${range}`),
  friction: (range) => `friction ${range}`,
  stiffening: (range) => (range === "0" ? null : `stiffens by ${range}`),
};

/** Parts of names by which segments are known to be of a tissue: the first that fits. */
const tissues: readonly (readonly [RegExp, string])[] = [
  [/tumou?r|carcinoma|metasta|\blesion/i, "tumour"],
  [/\b(muscle|psoas|gluteus|iliopsoas|autochthon)/i, "muscle"],
  [/\b(fat|adipose)/i, "fat"],
  [/\bliver/i, "liver"],
  [/\bskin/i, "skin"],
  [/\b(brain|cerebrum|cerebellum)/i, "brain"],
  [/\bcartilage/i, "cartilage"],
  [/\b(kidney|renal)/i, "kidney"],
  [/\bspleen/i, "spleen"],
  [/\b(breast|mamm)/i, "breast"],
  [/\bprostate/i, "prostate"],
  [/\blungs?\b/i, "lung"],
];

/** The soft tissue that a segment's name tells of; null where it tells of none that is offered. */
export function suggestedPreset(name: string, presets: readonly MaterialPreset[]): string | null {
  const suggested = tissues.find(([word]) => word.test(name))?.[1];
  return presets.find((preset) => preset.name === suggested)?.name ?? null;
}

/** Stiffer than this [Pa] is no soft tissue: cartilage has less, the softest bone more. */
const softest = 1e7;

/** Organs whose names tell of no preset, and the one that is most like each: the first that fits. */
const alike: readonly (readonly [RegExp, string])[] = [
  [/stomach|o?esophag|bladder|duoden|bowel|colon|intestin|rect(um|al)|uter(us|ine)|heart|myocard/i, "muscle"],
  [/aorta|vein|vena|arter|vessel/i, "vessel-wall"],
  [/lymph/i, "fat"],
  [/menisc|disc\b|larynx|trachea/i, "cartilage"],
];

/** The tissues that a segment can be made of where its name tells of none: the one most like it first. */
export function softTissues(name: string, presets: readonly MaterialPreset[]): readonly MaterialPreset[] {
  const soft = presets.filter(({ needs_hounsfield, high }) => !needs_hounsfield && high.young < softest);
  // most organs are as soft as the liver
  const first = alike.find(([word]) => word.test(name))?.[1] ?? "liver";
  return [...soft.filter((preset) => preset.name === first), ...soft.filter((preset) => preset.name !== first)];
}

/** Materials that a scan with values of this unit can have. */
export function presetsFor(presets: readonly MaterialPreset[], unit: string): readonly MaterialPreset[] {
  return presets.filter(({ needs_hounsfield }) => unit === "HU" || !needs_hounsfield);
}

/** What is soft by its material, and hard because it does not stand where the scan has it. */
export function movedTissue<Known extends Pick<Segment, "material" | "pose">>(segments: readonly Known[]): Known[] {
  return segments.filter(({ material, pose }) => material !== null && pose !== null);
}

/** The box that a model has: as chosen, or as many nodes or cells as usual; null where it has none. */
export function edgeOf(model: DeformationModel | undefined, edge: number | null): number | null {
  const boxes = model?.boxes ?? null;
  return boxes === null ? null : (edge ?? boxes.usual);
}

/** The nearest edge of a box that can be. */
export function oddEdge(edge: number, { least, most }: Boxes): number {
  const odd = 2 * Math.floor(edge / 2) + 1;
  return Math.min(most, Math.max(least, odd));
}

/** How many answers come in a second of the session, over the last one. */
export class AnswerRate {
  private counts: { readonly time: number; readonly answers: number }[] = [];

  /** Takes a count of answers so far; `time` [s]. */
  add(time: number, answers: number): void {
    const last = this.counts.at(-1);
    if (last !== undefined && (time < last.time || answers < last.answers)) {
      this.counts = [];
    }
    this.counts.push({ time, answers });
    while ((this.counts[1]?.time ?? time) <= time - 1) {
      this.counts.shift();
    }
  }

  /** [Hz]; 0 before there are two counts. */
  get hz(): number {
    const [first, last] = [this.counts[0], this.counts.at(-1)];
    return first === undefined || last === undefined || last.time <= first.time
      ? 0
      : (last.answers - first.answers) / (last.time - first.time);
  }
}
