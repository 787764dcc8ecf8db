/**
 * What a person sets once, by name: where it stands, and the words that it is looked for by.
 */
import { wordsOf } from "./action_search";

export const settingSections = ["Page", "Picture", "Touch", "Diagnostics"] as const;
export type SettingSection = (typeof settingSections)[number];

export interface Setting {
  readonly section: SettingSection;
  readonly name: string;
  /** Usual other words for it. */
  readonly words: string;
}

const table = {
  theme: { section: "Page", name: "Theme", words: "dark light mode colours colors appearance night" },
  quality: { section: "Picture", name: "Quality", words: "resolution sharp fine fast detail sampling rendering" },
  drawer: {
    section: "Picture",
    name: "Drawn by",
    words: "renderer rendering graphics card gpu cpu engine server browser webgl hardware acceleration",
  },
  frameBudget: { section: "Picture", name: "Frame budget", words: "frame rate fps speed smooth slow lag time" },
  editPace: { section: "Picture", name: "Update surfaces", words: "follow rate refresh edits mesh live" },
  stereo: {
    section: "Picture",
    name: "Stereo",
    words: "3d glasses anaglyph red cyan side by side top bottom eye distance projector screen depth",
  },
  mouse: { section: "Touch", name: "Mouse in touch mode", words: "surface plane pointer input hand" },
  model: {
    section: "Touch",
    name: "Contact model",
    words: "haptic algorithm thesis original improved exact proxy god object collision",
  },
  gain: { section: "Touch", name: "Gain", words: "scale workspace mapping sensitivity device speed" },
  damping: { section: "Touch", name: "Damping", words: "viscosity vibration buzz force stability device" },
  forceLimit: {
    section: "Touch",
    name: "Force limit",
    words: "maximum largest force newton safety clamp device strength",
  },
  normal: { section: "Touch", name: "Contact normal", words: "arrow surface direction show marker" },
  contactPoint: { section: "Touch", name: "Contact point", words: "surface point show marker dot" },
  ball: { section: "Touch", name: "Probe at true size", words: "sphere radius show marker cursor" },
  path: { section: "Touch", name: "Path of the probe", words: "trail history line show marker" },
  sound: { section: "Touch", name: "Sound of contact", words: "audio volume mute noise hear" },
  rumble: { section: "Touch", name: "Rumble in contact", words: "gamepad controller vibration haptic joystick" },
  diagnostics: {
    section: "Diagnostics",
    name: "Diagnostics",
    words: "rates servo late latency ticks hz fps real-time priority performance device simulation picture lag slow",
  },
} as const satisfies Readonly<Record<string, Setting>>;

export type SettingName = keyof typeof table;
export const settings: Readonly<Record<SettingName, Setting>> = table;
export const settingNames = Object.keys(table) as readonly SettingName[];

/** Whether what was typed means a setting: each word begins a word of its name, its section or its other words. */
export function isMeant({ section, name, words }: Setting, typed: string): boolean {
  const known = wordsOf(`${name} ${section} ${words}`);
  return wordsOf(typed).every((word) => known.some((each) => each.startsWith(word)));
}
