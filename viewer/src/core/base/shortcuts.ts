/**
 * Keys as actions name them: "F", "Shift+G", "Ctrl+Z", "Esc", and as the browser tells them.
 */

/** What the browser tells of a key. */
export interface KeyPress {
  readonly key: string;
  readonly ctrlKey: boolean;
  readonly metaKey: boolean;
  readonly shiftKey: boolean;
}

const names: Readonly<Record<string, string>> = { Escape: "Esc" };

/**
 * What a press may mean, the most particular first. Shift is held to lead the hand: without a meaning
 * of its own it changes nothing. On a Mac Command is as good as Ctrl.
 */
export function shortcutsOf({ key, ctrlKey, metaKey, shiftKey }: KeyPress): readonly string[] {
  const name = names[key] ?? (key.length === 1 ? key.toUpperCase() : key);
  if (ctrlKey || metaKey) {
    return [`Ctrl+${shiftKey ? "Shift+" : ""}${name}`];
  }
  return shiftKey ? [`Shift+${name}`, name] : [name];
}

/** As people read it: with spaces, and a minus that can be seen. */
export function shownShortcut(shortcut: string): string {
  return shortcut.length === 1 ? shortcut.replace("-", "\u2212") : shortcut.split("+").join(" + ");
}

/** Keys that stand at the end of what a control says of itself: "Show all (F)". */
const atEnd = /^(.+) \(((?:Ctrl\+|Shift\+)*(?:.|Esc|Enter|Delete))\)$/s;

/** A control's words, and the key that does the same; an empty one where none is said. */
export function splitShortcut(title: string): { readonly text: string; readonly key: string } {
  const [, text, key] = atEnd.exec(title) ?? [];
  return text === undefined || key === undefined ? { text: title, key: "" } : { text, key };
}
