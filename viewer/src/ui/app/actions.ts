/**
 * All that a person can have the page do by a key or by its name: one table, which the keyboard, the
 * help and the palette of commands share.
 */
import { formatValue } from "../../core/base/format";
import { letters, sideName } from "../../core/geometry/anatomy";
import { presets } from "../../core/appearance/curve_presets";
import { blendNames, qualityNames, stereoNames } from "../../core/appearance/picture_names";
import { blends } from "../../core/appearance/optics";
import { qualities } from "../../core/view/quality";
import { sliceNames, sliceTitle } from "../../core/slices/slice_plane";
import { stereoModes } from "../../core/view/stereo";
import { toolChoices } from "../../core/tools/tools";
import { larger, stiffer } from "../../core/touch/touch_settings";
import type { Vec3 } from "../../core/geometry/vector";
import { layoutNames, layouts } from "../../core/view/picture_layout";
import { formats, type Exporter } from "../features/scan/exporter.svelte";
import type { HandControl } from "../features/touch/hand_control.svelte";
import { anatomy } from "../features/appearance/appearance_control.svelte";
import type { Session } from "../state/session.svelte";
import type { Stage } from "./stage";
import { settings, settingNames } from "../../core/base/settings";
import { groups, type Group as PanelGroup } from "./panel_groups.svelte";
import { themes, type ThemeControl } from "../theme/theme.svelte";
import type { ToolHand } from "../features/tools/tool_hand.svelte";
import type { UndoControl } from "./undo_control";

export type Group = "Look" | "Slices" | "Touch" | "Tools" | "Marks" | "Work";

/** What the groups are called. @texts */
export const groupNames: Readonly<Record<Group, string>> = {
  Look: "Look",
  Slices: "Slices",
  Touch: "Touch",
  Tools: "Tools",
  Marks: "Marks",
  Work: "Work",
};

export interface Action {
  readonly group: Group;
  /** What it does, as a person would say it. */
  readonly name: string;
  /** Usual other words for it. */
  readonly words?: string;
  /** The first one is shown; the others do the same. */
  readonly keys: readonly string[];
  readonly run: () => void;
  /** For an action that lasts as long as its key is held: ends it. Such a one is in no palette. */
  readonly end?: () => void;
  /** Whether a key that is held does it again and again, as a step. */
  readonly repeats?: boolean;
  /** Its keys mean it only while the mouse or the keyboard is at a slice; there before what they mean elsewhere. */
  readonly overSlice?: boolean;
  /** Whether it means something now; always where it is left out. */
  readonly ready?: () => boolean;
}

/** What actions work on. */
export interface ActionTargets {
  readonly session: Session;
  readonly stage: Stage;
  readonly hand: HandControl;
  readonly tool: ToolHand;
  readonly undo: UndoControl;
  readonly exporter: Exporter;
  readonly theme: ThemeControl;
  /** What concerns the page as a whole. */
  readonly page: {
    readonly open: () => void;
    readonly second: () => void;
    readonly segments: () => void;
    /** Asks for the file of a preset of transfer functions. */
    readonly preset: () => void;
    readonly save: () => void;
    readonly help: () => void;
    readonly palette: () => void;
    readonly tour: () => void;
    readonly sound: () => void;
    readonly guarantees: () => void;
    /** Shows the settings that some words mean; all without a word. */
    readonly settings: (typed?: string) => void;
    /** Shows a group of the left panel. */
    readonly group: (group: PanelGroup) => void;
    readonly panel: (side: "left" | "right") => void;
    readonly escape: () => void;
  };
}

/** Turn of what the probe holds by one press [rad]. */
const turnStep = (2 * Math.PI) / 180;

export function actionsOf(targets: ActionTargets): readonly Action[] {
  return [look, picture, slices, feel, touch, tools, marks, work].flatMap((group) => group(targets));
}

function look({ session, stage }: ActionTargets): readonly Action[] {
  const group = "Look";
  const known = session.scan?.orientation_known ?? true;
  return [
    { group, name: "Show all", keys: ["F"], run: () => { stage.view.frameAll(); } },
    { group, name: "Bring the probe to the middle", keys: ["C"], run: () => { stage.centreOnProbe(); } },
    { group, name: "Back to the first view", keys: ["R"], run: () => { stage.view.reset(); } },
    ...letters.map((letter, i) => ({
      group,
      name: `Look from ${sideName(letter, known)}`,
      keys: [String(i + 1)],
      run: () => { stage.view.lookFrom(letter); },
    }) as const),
    {
      group,
      name: "Orthographic, or in perspective",
      keys: ["O"],
      run: () => { stage.view.orthographic = !stage.view.orthographic; },
    },
    {
      group,
      name: "Stereo: red–cyan, side by side, top–bottom, off",
      keys: ["Shift+S"],
      run: () => { stage.stereo.next(); },
    },
    ...stereoModes.map((mode) => ({
      group,
      name: `Stereo: ${stereoNames[mode].name}`,
      keys: [],
      run: () => { stage.stereo.choose({ mode }); },
    }) as const),
    ...blends.map((blend) => ({
      group,
      name: `Draw as ${blendNames[blend].name}`,
      keys: [],
      run: () => { stage.appearance.choose("blend", blend); },
    }) as const),
    ...[anatomy, ...presets.map(({ name }) => name)].map((name) => ({
      group,
      name: `Transfer function ${name}`,
      keys: [],
      run: () => { stage.appearance.usePreset(name); },
    }) as const),
  ];
}

/** How the picture is made, cut and kept. */
function picture({ stage, page }: ActionTargets): readonly Action[] {
  const group = "Look";
  const { appearance, clips, images } = stage;
  const drawable = (): boolean => stage.view.camera !== null && images.job === null;
  const lit = (): boolean => appearance.choice?.blend === "shaded";
  return [
    { group, name: "Import a transfer function of 3D Slicer", keys: [], run: page.preset },
    {
      group,
      name: "Lighting on, off",
      keys: [],
      ready: () => lit() || appearance.choice?.blend === "composite",
      run: () => {
        appearance.choose("blend", lit() ? "composite" : "shaded");
      },
    },
    ...qualities.map(
      (quality) =>
        ({
          group,
          name: `Quality: ${qualityNames[quality].name}`,
          keys: [],
          run: () => {
            stage.quality.choose({ quality });
          },
        }) as const,
    ),
    {
      group,
      name: "Clip box on, off",
      keys: [],
      run: () => {
        clips.switchBox(!clips.clip.box.on);
      },
    },
    {
      group,
      name: "Add a clip plane through the middle of the view",
      keys: [],
      ready: () => stage.view.camera !== null && !clips.full,
      run: () => {
        if (stage.view.camera !== null) clips.addPlane(stage.view.camera);
      },
    },
    {
      group,
      name: "Cut touch with the clip box and planes on, off",
      keys: [],
      run: () => {
        stage.touchClip.switch(!stage.touchClip.on);
      },
    },
    {
      group,
      name: "Clip nothing",
      keys: [],
      ready: () => clips.cutting.length > 0,
      run: () => {
        clips.reset();
      },
    },
    {
      group,
      name: "Save a picture of the view",
      keys: [],
      ready: () => drawable() && images.fits(images.choice.magnification),
      run: () => void images.saveImage(),
    },
    {
      group,
      name: "Record a turntable of the view",
      keys: [],
      ready: () => drawable() && images.canAnimate,
      run: () => void images.saveAnimation(),
    },
  ];
}

function slices({ session, stage }: ActionTargets): readonly Action[] {
  const group = "Slices";
  const known = session.scan?.orientation_known ?? true;
  return [
    { group, name: "3-D view alone, with a slice, with three", keys: ["L"], run: () => { stage.slices.nextLayout(); } },
    ...layouts.map((layout) => ({
      group,
      name: layoutNames[layout],
      keys: [],
      run: () => { stage.slices.change({ layout }); },
    }) as const),
    {
      group,
      name: "Maximise the pane under the mouse, and back",
      keys: ["Shift+F"],
      run: () => { stage.slices.toggleAlone(stage.slices.underKeys ?? "view"); },
    },
    ...sliceNames.map((single) => ({
      group,
      name: single === "oblique" ? "Oblique slice, along the view" : `Slice: ${sliceTitle(single, known)}`,
      keys: [],
      run: () => { stage.slices.change({ layout: "slice", single }); },
    }) as const),
    ...windows(stage),
    { group, name: "Show all of each slice", keys: [], run: () => { stage.slices.fit(); } },
  ];
}

/** Windows on the digits, over a slice: one for each, so that none means anything else there. */
function windows({ slices }: Stage): readonly Action[] {
  return [1, 2, 3, 4, 5, 6, 7, 8, 9].map((digit) => {
    const preset = slices.presets[digit - 1];
    const figures = preset === undefined ? "" : `${formatValue(preset.window)} / ${formatValue(preset.level)}`;
    return {
      group: "Slices",
      name: preset === undefined ? `Window ${String(digit)}: none` : `Window ${preset.name} ${figures}`,
      keys: [String(digit)],
      overSlice: true,
      ready: () => preset !== undefined,
      run: () => { slices.usePreset(digit - 1); },
    };
  });
}

/** What the mouse leads, and how touch feels. */
function feel({ session, hand }: ActionTargets): readonly Action[] {
  const group = "Touch";
  const ready = (): boolean => session.settings !== null;
  const change =
    (part: (settings: NonNullable<Session["settings"]>) => Parameters<Session["changeSettings"]>[0]) => (): void => {
      if (session.settings !== null) {
        session.changeSettings(part(session.settings));
      }
    };
  return [
    {
      group,
      name: "Touch mode: the mouse presses on what is drawn",
      keys: ["T"],
      run: () => { hand.touchMode = !hand.touchMode; },
    },
    {
      group,
      name: "Softer",
      keys: ["["],
      repeats: true,
      ready,
      run: change(({ stiffness }) => ({ stiffness: stiffer(stiffness, -1, session.deviceLimits) })),
    },
    {
      group,
      name: "Stiffer",
      keys: ["]"],
      repeats: true,
      ready,
      run: change(({ stiffness }) => ({ stiffness: stiffer(stiffness, 1, session.deviceLimits) })),
    },
    {
      group,
      name: "A smaller probe",
      keys: ["-"],
      repeats: true,
      ready,
      run: change(({ probe_radius }) => ({ probe_radius: larger(probe_radius, -1) })),
    },
    {
      group,
      name: "A larger probe",
      keys: ["+", "="],
      repeats: true,
      ready,
      run: change(({ probe_radius }) => ({ probe_radius: larger(probe_radius, 1) })),
    },
    {
      group,
      name: "Smooth surface, or voxel steps",
      keys: ["V"],
      ready,
      run: change(({ smoothing }) => ({ smoothing: smoothing === "off" ? "intensities" : "off" })),
    },
  ];
}

function touch({ session, stage, hand, page }: ActionTargets): readonly Action[] {
  const group = "Touch";
  const turn = (direction: number) => (): void => {
    if (stage.view.camera !== null) {
      stage.objects.turn(stage.view.camera.back, direction * turnStep);
    }
  };
  const holds = (): boolean => stage.objects.holds;
  return [
    {
      group,
      name: "Show or hide the contact normal",
      keys: ["N"],
      run: () => { stage.touch.change({ normal: !stage.touch.shown.normal }); },
    },
    {
      group,
      name: "Show or hide the path of the probe",
      keys: ["P"],
      run: () => { stage.touch.change({ path: !stage.touch.shown.path }); },
    },
    {
      group,
      name: "Held: the hand moves without the probe (clutch)",
      keys: ["K"],
      run: () => { hand.clutch(true); },
      end: () => { hand.clutch(false); },
    },
    {
      group,
      name: "Held: grab the touched segment, it follows the probe",
      keys: ["G"],
      run: () => {
        if (!stage.objects.holds) stage.objects.grab();
      },
      end: () => { stage.objects.release(); },
    },
    { group, name: "Turn what is grabbed to the left", keys: [","], repeats: true, ready: holds, run: turn(1) },
    { group, name: "Turn what is grabbed to the right", keys: ["."], repeats: true, ready: holds, run: turn(-1) },
    { group, name: "Sound of contact on, off", keys: ["S"], run: page.sound },
    { group, name: "Force checks: what is counted, what waits", keys: ["Shift+G"], run: page.guarantees },
    { group, name: "Record touch, stop recording", keys: ["Shift+R"], run: () => { session.toggleRecording(); } },
  ];
}

function tools({ stage, tool }: ActionTargets): readonly Action[] {
  const group = "Tools";
  return [
    ...toolChoices.map(({ kind, name, key, does }) => ({
      group,
      name: `${name}: ${does}`,
      keys: [key.toUpperCase()],
      run: () => { tool.choose(kind); },
    }) as const),
    {
      group,
      name: "Brush in slices: paint or erase a segment",
      keys: ["Q"],
      run: () => { stage.toggleBrush(); },
    },
    {
      group,
      name: "Held: the tool works",
      keys: ["X"],
      ready: () => tool.kind !== "none",
      run: () => { tool.press(); },
      end: () => { tool.release(); },
    },
    {
      group,
      name: "Keep the region that was found, or cut along the painted line",
      keys: ["Enter"],
      ready: () => stage.growing.shown !== null || stage.cutting.ready || stage.scissors.ready,
      run: () => {
        if (stage.growing.shown !== null) stage.growing.end(true);
        else if (stage.cutting.ready) stage.cutting.cut();
        else stage.scissors.remove();
      },
    },
  ];
}

function marks({ session, stage }: ActionTargets): readonly Action[] {
  const group = "Marks";
  const put = (point: Vec3 | undefined | null): void => {
    if (point !== undefined && point !== null) {
      stage.marks.set(point);
    }
  };
  return [
    { group, name: "Mark a point", keys: ["B"], run: () => { stage.marks.start("point"); } },
    { group, name: "Measure a distance", keys: ["M"], run: () => { stage.marks.start("distance"); } },
    { group, name: "Measure an angle", keys: ["Shift+M"], run: () => { stage.marks.start("angle"); } },
    ...([["ellipse", "U"], ["rectangle", "Shift+U"]] as const).map(([kind, key]) => ({
      group,
      name: `Draw an area in a slice: ${kind}`,
      keys: [key],
      run: () => {
        stage.marks.start(kind);
        stage.slices.reveal();
      },
    }) as const),
    {
      group,
      name: "Plan a needle path: target, then entry",
      keys: ["Shift+I"],
      run: () => { stage.planPath(); },
    },
    {
      group,
      name: "Set a point at the probe",
      keys: ["J"],
      ready: () => session.latest !== null,
      run: () => { put(session.latest?.proxy); },
    },
    {
      group,
      name: "Set a point at the crosshair of slices",
      keys: ["Shift+J"],
      ready: () => stage.slices.crosshair !== null,
      run: () => { put(stage.slices.crosshair); },
    },
    {
      group,
      name: "Delete all marks",
      keys: [],
      ready: () => stage.marks.all.length > 0,
      run: () => { stage.marks.removeAll(); },
    },
  ];
}

function work({ session, stage, undo, exporter, theme, page }: ActionTargets): readonly Action[] {
  const group = "Work";
  return [
    { group, name: "Undo", keys: ["Ctrl+Z"], run: () => { undo.undo(); } },
    { group, name: "Redo", keys: ["Ctrl+Shift+Z", "Ctrl+Y"], run: () => { undo.redo(); } },
    { group, name: "Open another scan", keys: ["Ctrl+O"], run: page.open },
    { group, name: "Add a second scan", keys: [], run: page.second },
    { group, name: "Add segments from a file", keys: [], run: page.segments },
    {
      group,
      name: "Add a segment by threshold",
      keys: [],
      ready: () => session.scan !== null,
      run: () => { session.addThreshold(); },
    },
    {
      group,
      name: "Remove the table",
      keys: [],
      ready: () => stage.removal.isLikely && stage.removal.table === null,
      run: () => { stage.removal.findTable(); },
    },
    {
      group,
      name: "Scissors: cut out what a loop on the picture encloses",
      keys: [],
      ready: () => session.scan !== null,
      run: () => { stage.takeScissors(); },
    },
    {
      group,
      name: "Crop the scan to the clip box",
      keys: [],
      ready: () => stage.clips.clip.box.on,
      run: () => { stage.removal.crop(stage.clips.clip.box); },
    },
    ...formats.map((format) => ({
      group,
      name: `Export: ${format.label}`,
      keys: [],
      ready: () => !exporter.busy && exporter.canMake(format),
      run: () => {
        exporter.choose(format.name);
        void exporter.export();
      },
    }) as const),
    { group, name: "Save the scene", keys: ["Ctrl+S"], run: page.save },
    { group, name: "All actions and their keys", keys: ["Ctrl+K"], run: page.palette },
    { group, name: "Settings", keys: ["Ctrl+,"], run: () => { page.settings(); } },
    ...settingNames.map((each) => ({
      group,
      name: `Settings: ${settings[each].name}`,
      words: settings[each].words,
      keys: [],
      run: () => { page.settings(settings[each].name); },
    }) as const),
    ...groups.map(({ name, title }) => ({
      group,
      name: `Show the group ${title}`,
      keys: [],
      run: () => { page.group(name); },
    }) as const),
    { group, name: "Help: mouse and keys", keys: ["?"], run: page.help },
    { group, name: "Show the tour", keys: [], run: page.tour },
    { group, name: "Show or hide the left panel", keys: [], run: () => { page.panel("left"); } },
    { group, name: "Show or hide the right panel", keys: [], run: () => { page.panel("right"); } },
    ...themes.map(({ choice, name }) => ({
      group,
      name: `${settings.theme.name}: ${name}`,
      words: settings.theme.words,
      keys: [],
      run: () => { theme.choose(choice); },
    }) as const),
    { group, name: "No cut, no mark, no growing, no brush, leave touch mode, close", keys: ["Esc"], run: page.escape },
  ];
}
