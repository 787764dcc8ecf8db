/**
 * The second scan on the page: its values, and how a person wants it shown; kept with the first scan.
 */
import { transformPoint } from "../../../core/geometry/affine";
import { isCurve, transferFunctionOfCurve, type Curve } from "../../../core/appearance/curve";
import { curveOfPreset, presets } from "../../../core/appearance/curve_presets";
import { valueBetweenVoxels, valueInVoxel } from "../../../core/scan/field";
import { valueAbove } from "../../../core/scan/histogram";
import { firstChoice, firstTissue, type OpticsChoice } from "../../../core/appearance/optics";
import type { Scan, SecondScan } from "../../../core/protocol";
import { frameOf } from "../../../core/scan/scan_volume";
import {
  fusions,
  placeOf,
  tints,
  type Fusion,
  type SecondAppearance,
  type Tint,
} from "../../../core/second/second_scan";
import { areIsolines, firstIsolines, shownIsolines, type Isoline, type Isolines } from "../../../core/second/isolines";
import { subsamplingStep } from "../../../core/scan/subsampling";
import { KeepEqual } from "../../../core/base/keep_equal";
import type { Vec3 } from "../../../core/geometry/vector";
import { firstWindow, type WindowLevel } from "../../../core/appearance/window_level";
import type { ShownSecond } from "../../../gl/textures/second_texture";
import { bringSegments, moveSecond, removeSecond } from "../../../live/second_requests";
import { downloadVolume, type DownloadedScan } from "../../../live/volume_download";
import { PageState } from "../../state/page_state.svelte";
import type { PageSteps } from "../../state/page_steps.svelte";
import type { ScanMemory } from "../../state/scan_memory";

/** What a person chooses. */
export interface SecondChoice {
  readonly inView: boolean;
  readonly inSlices: boolean;
  /** How view and slices show both. */
  readonly fusion: Fusion;
  /** Transfer function of the 3-D view: one by name, or points of its own that began as that. */
  readonly preset: string;
  readonly curve: Curve | null;
  readonly density: number;
  /** Value of its iso-surface. */
  readonly iso: number;
  /** Of the modes that show one value of each ray. */
  readonly windows: OpticsChoice["windows"];
  /** Of slices. */
  readonly window: number;
  readonly level: number;
  readonly tint: Tint;
  readonly opacity: number;
  readonly square: number;
  readonly isolines: Isolines;
}

/** What of it is changed, as a step of undo says it. @texts */
const partNames: Readonly<Record<keyof SecondChoice, string>> = {
  inView: "shown in the view",
  inSlices: "shown in slices",
  fusion: "fusion",
  preset: "transfer function",
  curve: "transfer function",
  density: "density",
  iso: "iso-value",
  windows: "window and level in the view",
  window: "window",
  level: "level",
  tint: "colour",
  opacity: "opacity",
  square: "squares",
  isolines: "lines of equal value",
};

/** Until the other one of two is seen [ms]. */
const flickerTime = 700;

/** Values between which a full boundary lies, per mm, as a share of those of tissue and bone. */
const edgeShare = 0.2;

/** Share of the voxels that may be brighter than the brightest of a preset. */
const fewVoxels = 2e-4;

interface Outside {
  readonly steps: PageSteps;
  /** What is kept with the first scan. */
  readonly memory: ScanMemory;
  /** Largest scan that the GPU takes. */
  readonly limits: { readonly edge: number; readonly values: number };
  readonly complain: (text: string) => void;
}

export class SecondControl {
  /** As the engine has reported it; null where there is none. */
  reported = $state.raw<SecondScan | null>(null);
  /** Share that has arrived; null where all has. */
  progress = $state.raw<number | null>(null);
  /** The scan that slices show alone for now; null where they show both as was chosen. */
  only = $state.raw<SecondAppearance["turn"] | null>(null);
  /** The engine is laying it elsewhere. */
  busy = $state.raw(false);
  /** How it is shown: each change is a step of undo, a whole drag too; null where there is none. */
  private readonly state: PageState<SecondChoice | null>;
  private held = $state.raw<DownloadedScan | null>(null);
  private turn = $state.raw<SecondAppearance["turn"]>("second");
  private timer: ReturnType<typeof setInterval> | null = null;
  private readonly sameFunction = new KeepEqual<SecondAppearance["transferFunction"]>();

  constructor(private readonly outside: Outside) {
    this.state = new PageState<SecondChoice | null>(null, outside.steps, this.keep.bind(this));
    outside.memory.onChange((name) => {
      const scan = this.reported?.scan ?? null;
      if (scan !== null && name === partOf(scan)) {
        this.state.take(choiceFor(scan, outside.memory));
        this.follow();
      }
    });
  }

  get choice(): SecondChoice | null {
    return this.state.now;
  }

  /** Takes what the engine tells: another scan, another place of it, or none any more. */
  async take(reported: SecondScan): Promise<void> {
    const before = this.reported;
    const { scan } = reported;
    this.reported = scan === null ? null : reported;
    if (scan === null) {
      this.state.open(null);
      this.held = null;
      this.progress = null;
    } else if (before?.version !== reported.version) {
      await this.open(scan, reported.version);
    }
    this.follow();
  }

  /** Points of its transfer function; null before there is one. */
  readonly curve = $derived.by((): Curve | null => {
    const { choice, reported } = this;
    const scan = reported?.scan ?? null;
    const preset = presets.find(({ name }) => name === choice?.preset);
    if (choice === null || scan === null || preset === undefined) {
      return null;
    }
    const anchors = { softTissue: scan.soft_tissue, bone: scan.bone };
    return choice.curve ?? curveOfPreset(preset, anchors, scan.range[0], valueAbove(scan.histogram, fewVoxels));
  });

  /** All that is shown of it; null before it is here. */
  readonly shown = $derived.by((): ShownSecond | null => {
    const { choice, curve, held, reported, turn, only } = this;
    const place = reported === null ? null : placeOf(reported);
    const scan = reported?.scan ?? null;
    if (choice === null || curve === null || held === null || scan === null || place === null) {
      return null;
    }
    const anchors = { softTissue: scan.soft_tissue, bone: scan.bone };
    const transferFunction = this.sameFunction.of(transferFunctionOfCurve(curve), JSON.stringify(curve));
    const edgeGradient = edgeShare * Math.abs(anchors.bone - anchors.softTissue);
    const { inView, inSlices, density, iso, windows, window, level, fusion, tint, opacity, square } = choice;
    const lines = shownIsolines(choice.isolines);
    const inSlice = { inSlices, window: { window, level }, fusion, tint, opacity, square, lines, turn };
    const surface = { isoValue: iso, tissueFrom: firstTissue(anchors), windows };
    const alone = only === null ? {} : ({ inSlices: true, fusion: "flicker", turn: only } as const);
    return {
      ...held,
      place,
      appearance: {
        inView,
        viewFusion: fusion,
        transferFunction,
        density,
        edgeGradient,
        ...surface,
        ...inSlice,
        ...alone,
      },
    };
  });

  /** Lines of equal value that slices show, the highest first. */
  readonly lines = $derived.by((): readonly Isoline[] => {
    const appearance = this.shown?.appearance ?? null;
    return appearance?.inSlices === true ? [...appearance.lines].reverse() : [];
  });

  /** Its value at a point of the first scan's scene; null outside of it and before it is here. */
  valueAt(point: Vec3): number | null {
    const { shown } = this;
    if (shown === null) {
      return null;
    }
    const grid = transformPoint(shown.volume.frame.gridFromScene, transformPoint(shown.place, point));
    // a dose is read as its lines are drawn
    const read = this.reported?.scan?.modality === "RTDOSE" ? valueBetweenVoxels : valueInVoxel;
    return read(shown.volume, grid);
  }

  /** Lays it where a transform's file says; null: as its own file does. */
  async moveBy(transform: File | null): Promise<void> {
    await this.ask(moveSecond(transform));
  }

  /** Brings segments that were drawn on it to the first scan, where it lies now. */
  async bringSegments(file: File): Promise<void> {
    await this.ask(bringSegments(file));
  }

  async remove(): Promise<void> {
    await this.ask(removeSecond());
  }

  /** Shows it otherwise; numbers and windows have sliders. */
  change(part: Partial<SecondChoice>): void {
    const keys = Object.keys(part) as (keyof SecondChoice)[];
    const slides = Object.values(part).every((value) => typeof value === "number" || typeof value === "object");
    this.set(part, keys.map((key) => partNames[key]).join(", "), slides);
  }

  /** The transfer function of this name, without changes. */
  usePreset(preset: string): void {
    this.set({ preset, curve: null }, "transfer function", false);
  }

  /** Other points of its transfer function; while they are dragged all are one step of undo. */
  drawPoints(curve: Curve, live: boolean): void {
    this.set({ curve }, "transfer function", live);
  }

  private set(part: Partial<SecondChoice>, name: string, slides: boolean): void {
    if (this.choice !== null) {
      this.state.change(`second scan, ${name}`, { ...this.choice, ...part }, slides);
    }
  }

  private keep(choice: SecondChoice | null): void {
    const scan = this.reported?.scan ?? null;
    if (choice !== null && scan !== null) {
      this.outside.memory.keep(partOf(scan), choice);
      this.follow();
    }
  }

  private async ask(answer: Promise<void>): Promise<void> {
    this.busy = true;
    try {
      await answer;
    } catch (error) {
      this.outside.complain(error instanceof Error ? error.message : String(error));
    } finally {
      this.busy = false;
    }
  }

  private async open(scan: Scan, version: number): Promise<void> {
    const frame = frameOf(scan);
    this.state.open(choiceFor(scan, this.outside.memory));
    this.held = null;
    this.progress = 0;
    const still = (): boolean => this.reported?.version === version;
    try {
      const step = subsamplingStep(frame.dimensions, this.outside.limits);
      const held = await downloadVolume(frame, step, {
        path: "/api/second",
        progress: (share) => {
          this.progress = still() ? share : this.progress;
        },
      });
      this.held = still() ? held : this.held;
    } catch (error) {
      if (still()) {
        this.outside.complain(
          `The second scan did not arrive: ${error instanceof Error ? error.message : String(error)}`,
        );
      }
    }
    this.progress = still() ? null : this.progress;
  }

  /** Lets two scans take turns where they are to. */
  private follow(): void {
    const { choice } = this;
    const isSeen = choice !== null && (choice.inSlices || choice.inView);
    const flickers = this.reported !== null && isSeen && choice.fusion === "flicker";
    if (flickers && this.timer === null) {
      this.timer = setInterval(() => {
        this.turn = this.turn === "second" ? "first" : "second";
      }, flickerTime);
    } else if (!flickers && this.timer !== null) {
      clearInterval(this.timer);
      this.timer = null;
      this.turn = "second";
    }
  }
}

/** Under which name it is kept. */
function partOf(scan: Scan): string {
  return `second.${scan.identity}`;
}

/** As it was shown last with this first scan, else as fits it. */
function choiceFor(scan: Scan, memory: ScanMemory): SecondChoice {
  const isDose = scan.modality === "RTDOSE";
  // of most voxels of a dose there is little, and it is the highest that counts
  const whole = { window: scan.range[1], level: scan.range[1] / 2 };
  const { window, level }: WindowLevel = isDose ? whole : firstWindow(scan);
  const { windows } = firstChoice(
    { softTissue: scan.soft_tissue, bone: scan.bone },
    valueAbove(scan.histogram, fewVoxels),
  );
  const fitting: SecondChoice = {
    // a dose is read by its lines; as tissue it would hide the patient
    inView: !isDose,
    inSlices: true,
    preset: scan.unit === "HU" ? "CT-Bone" : "MR-Default",
    curve: null,
    // the first scan is seen through it
    density: 0.4,
    iso: scan.bone,
    windows,
    window,
    level,
    fusion: "blend",
    tint: "warm",
    opacity: isDose ? 0.25 : 0.6,
    square: 20,
    isolines: firstIsolines(scan),
  };
  const kept = memory.recall(partOf(scan), fitting);
  const named =
    fusions.includes(kept.fusion) && tints.includes(kept.tint) && presets.some(({ name }) => name === kept.preset);
  const known = named && areIsolines(kept.isolines) && (kept.curve === null || isCurve(kept.curve));
  return known ? kept : fitting;
}
