/**
 * The controls of the page, made from the ground up: each is given only what it needs of those before it.
 */
import type { GpuSupport } from "../../gl/base/gpu_support";
import { AppearanceControl } from "../features/appearance/appearance_control.svelte";
import { PresetPictures } from "../features/appearance/preset_pictures.svelte";
import { AreaMeasures } from "../features/marks/area_measures.svelte";
import { MarkControl } from "../features/marks/mark_control.svelte";
import { Pointed } from "../features/picking/pointed.svelte";
import { Readout } from "../features/picking/readout.svelte";
import { EditRateControl } from "../features/scan/edit_rate_control.svelte";
import { RemovalControl } from "../features/scan/removal_control.svelte";
import { mostValues } from "../features/scan/scan_loader.svelte";
import { Player } from "../features/scenario/player.svelte";
import { RegistrationControl } from "../features/second/registration_control.svelte";
import { SecondControl } from "../features/second/second_control.svelte";
import { BrushControl } from "../features/segments/brush_control.svelte";
import { CutControl } from "../features/segments/cut_control.svelte";
import { GrowControl } from "../features/segments/grow_control.svelte";
import { IslandsControl } from "../features/segments/islands_control.svelte";
import { ObjectControl } from "../features/segments/object_control.svelte";
import { ScissorsControl } from "../features/segments/scissors_control.svelte";
import { SegmentAppearanceControl } from "../features/segments/segment_appearance_control";
import type { SegmentControls } from "../features/segments/segment_controls";
import { StatisticsControl } from "../features/segments/statistics_control.svelte";
import { SurfaceExport } from "../features/segments/surface_export.svelte";
import { ThresholdPreview } from "../features/segments/threshold_preview.svelte";
import { SliceControl } from "../features/slices/slice_control.svelte";
import { DrillStrokes } from "../features/tools/drill_strokes.svelte";
import { NeedleDirectionControl } from "../features/tools/needle_direction.svelte";
import { NeedleGuide } from "../features/tools/needle_guide.svelte";
import { TouchMarkers } from "../features/touch/touch_markers.svelte";
import { ClipControl } from "../features/view/clip_control.svelte";
import { DrawerControl } from "../features/view/drawer_control.svelte";
import { QualityControl } from "../features/view/quality_control.svelte";
import { StereoControl } from "../features/view/stereo_control.svelte";
import { TouchClip } from "../features/view/touch_clip.svelte";
import { ViewControl } from "../features/view/view_control.svelte";
import { EngineSteps } from "../state/engine_steps.svelte";
import { PageSteps } from "../state/page_steps.svelte";
import type { Session } from "../state/session.svelte";

/** What all controls are made from. */
export interface Surroundings {
  /** The engine's state. */
  readonly session: Session;
  /** What the GPU can do. */
  readonly support: GpuSupport;
  /** Access to the engine. */
}

interface UndoControls {
  /** Steps of undo that only the page knows, in their order. */
  readonly steps: PageSteps;
  /** How many steps of the engine came before each. */
  readonly engineSteps: EngineSteps;
}

interface ViewControls {
  /** Camera, projection and size of the 3-D view. */
  readonly view: ViewControl;
  /** The slices beside it. */
  readonly slices: SliceControl;
  /** What each eye sees of the 3-D view. */
  readonly stereo: StereoControl;
  /** How fine the picture is. */
  readonly quality: QualityControl;
  /** Who draws the 3-D view. */
  readonly drawer: DrawerControl;
  /** What of the 3-D view is cut away. */
  readonly clips: ClipControl;
  /** Whether touch is cut with it. */
  readonly touchClip: TouchClip;
  /** How the scan is shown. */
  readonly appearance: AppearanceControl;
  /** What it would look like in each preset. */
  readonly presets: PresetPictures;
  /** What is taken out of the scan. */
  readonly removal: RemovalControl;
  /** How often the picture follows edits. */
  readonly editRate: EditRateControl;
  /** Points, distances and angles that a person has set. */
  readonly marks: MarkControl;
  /** Values in the areas among them. */
  readonly areas: AreaMeasures;
  /** What was clicked last: what it is, where, and its value. */
  readonly readout: Readout;
  /** What the mouse stands on in the 3-D view. */
  readonly pointed: Pointed;
}

interface TouchControls {
  /** Plays scenarios: their tool is shown in the picture then, and not the probe. */
  readonly player: Player;
  /** What of touch is drawn. */
  readonly touch: TouchMarkers;
  /** The line of the needle, and the one that was planned. */
  readonly needle: NeedleGuide;
  /** The direction in which it goes in. */
  readonly needleDirection: NeedleDirectionControl;
  /** What each stroke of the drill has done. */
  readonly strokes: DrillStrokes;
}

interface SecondControls {
  /** A second scan that is shown with the first. */
  readonly second: SecondControl;
  /** How it is registered to the first. */
  readonly registration: RegistrationControl;
}

/** All controls of the page. */
export interface Controls extends UndoControls, ViewControls, SegmentControls, TouchControls, SecondControls {}

export function makeControls(surroundings: Surroundings): Controls {
  const undo = undoControls(surroundings);
  const view = viewControls(surroundings, undo);
  return {
    ...undo,
    ...view,
    ...segmentControls(surroundings, undo),
    ...touchControls(surroundings, view),
    ...secondControls(surroundings, undo),
  };
}

function undoControls({ session }: Surroundings): UndoControls {
  const steps: PageSteps = new PageSteps(() => engineSteps.count);
  const engineSteps: EngineSteps = new EngineSteps(session, steps);
  return { steps, engineSteps };
}

function viewControls({ session, support }: Surroundings, { steps }: UndoControls): ViewControls {
  const view = new ViewControl(session);
  const slices = new SliceControl(steps, () => view.camera, session.memory);
  const clips = new ClipControl(steps, session.memory);
  const marks = new MarkControl(steps, session.memory);
  return {
    view,
    slices,
    stereo: new StereoControl(() => view.camera, () => slices.panes.view),
    quality: new QualityControl(support.software),
    drawer: new DrawerControl(support.software),
    clips,
    touchClip: new TouchClip(session, clips),
    appearance: new AppearanceControl(steps, session.memory),
    presets: new PresetPictures(),
    removal: new RemovalControl(session),
    editRate: new EditRateControl(session),
    marks,
    areas: new AreaMeasures(session, marks),
    readout: new Readout(),
    pointed: new Pointed(),
  };
}

function segmentControls({ session }: Surroundings, { steps }: UndoControls): SegmentControls {
  const scissors = new ScissorsControl(session);
  return {
    segmentAppearance: new SegmentAppearanceControl(session, steps),
    thresholdPreview: new ThresholdPreview(),
    objects: new ObjectControl(session),
    cutting: new CutControl(session, () => { scissors.cancel(); }),
    scissors,
    growing: new GrowControl(session),
    islands: new IslandsControl(session),
    brush: new BrushControl(session),
    statistics: new StatisticsControl(session),
    surfaces: new SurfaceExport(session),
  };
}

function touchControls({ session, support }: Surroundings, { marks, view }: ViewControls): TouchControls {
  const player = new Player(session);
  const needle = new NeedleGuide(marks);
  return {
    player,
    touch: new TouchMarkers(session, { player, needle }, support.software),
    needle,
    needleDirection: new NeedleDirectionControl(session, needle, () => view.camera),
    strokes: new DrillStrokes(session),
  };
}

function secondControls({ session, support }: Surroundings, { steps }: UndoControls): SecondControls {
  const second = new SecondControl({
    steps,
    memory: session.memory,
    limits: { edge: support.largestEdge, values: mostValues },
    complain: (text) => {
      session.notify("error", text);
    },
  });
  return { second, registration: new RegistrationControl(session, second, { steps }) };
}
