/**
 * What the mouse and a gamepad do, and the keys that move something: what is no action with a name. For
 * the help, beside the table of actions.
 */
import type { Group } from "./actions";

export interface HelpRow {
  readonly keys: string;
  readonly does: string;
}

export const gestures: Readonly<Record<Group, readonly HelpRow[]>> = {
  Look: [
    { keys: "Left drag", does: "turn" },
    { keys: "Wheel", does: "nearer, farther" },
    { keys: "Middle drag, Ctrl + left drag", does: "move the picture" },
    { keys: "Shift + arrows", does: "turn" },
    { keys: "Shift + Page Up, Page Down", does: "nearer, farther" },
    { keys: "Ctrl + arrows", does: "move the picture" },
    {
      keys: "Alt + left drag",
      does: "window (sideways) and level (up and down) of what is seen; of an iso-surface its value",
    },
    { keys: "Touch screen", does: "one finger turns, two move the picture and zoom" },
    { keys: "Click", does: "what is seen there, where, and its value; until the next click or Esc" },
  ],
  Slices: [
    { keys: "Click, left drag", does: "what is there; move the crosshair" },
    { keys: "Wheel, arrows up and down", does: "from slice to slice: a notch is a slice" },
    { keys: "Bar at the right, one finger", does: "go through the slices" },
    { keys: "Right drag", does: "window (sideways) and level (up and down)" },
    { keys: "Ctrl + wheel, + \u2212", does: "nearer, farther" },
    { keys: "Middle drag, Ctrl + left drag", does: "move the slice" },
    { keys: "Ctrl + arrows", does: "move the slice that has the focus" },
    { keys: "Double-click", does: "maximise the slice, and back" },
    { keys: "Shift + double-click, Shift + move", does: "bring the probe there, move the hand in the slice" },
    { keys: "Wire: Enter, Backspace", does: "close it, take its last point back" },
  ],
  Touch: [
    { keys: "Double-click", does: "bring the probe to what is seen there; an object says its name" },
    { keys: "Left button held, touch mode", does: "press on what is drawn, slide along it; released it lifts off" },
    { keys: "Wheel, touch mode", does: "press harder (roll forward) or more gently; Ctrl + wheel nearer, farther" },
    { keys: "Touch screen, touch mode", does: "one finger presses on what is drawn, two turn and zoom" },
    { keys: "Pen, touch mode", does: "its pressure is the force, up to what the wheel has set" },
    { keys: "Right drag, Shift + move", does: "move the hand in the view plane" },
    { keys: "… with the wheel", does: "away from you, toward you" },
    { keys: "Arrows, Page Up, Page Down", does: "move the hand; with Alt finely" },
    { keys: "Alt + wheel", does: "turn what is grabbed in the picture" },
  ],
  Tools: [{ keys: "Shift + left button held", does: "the tool works: the mouse leads it" }],
  Marks: [
    { keys: "Click", does: "set the next point, in the picture or in a slice; without the mouse by the keys below" },
    { keys: "Left drag on a point, arrows", does: "move it; arrows with Shift by 10 pixels" },
    { keys: "Delete", does: "delete the mark whose point has the focus" },
  ],
  Work: [],
};

export const gamepadRows: readonly HelpRow[] = [
  { keys: "Left stick, triggers", does: "move the hand in the view plane, away and toward you" },
  { keys: "Left shoulder", does: "held: finely" },
  { keys: "Right shoulder", does: "held: the tool works" },
  { keys: "Right stick", does: "turn the picture" },
  { keys: "A (lower button)", does: "sticks move the hand, or only turn the picture" },
  { keys: "Y (upper button)", does: "grab the touched segment, let go" },
  { keys: "B, X (right, left button)", does: "probe to the middle, first view" },
];
