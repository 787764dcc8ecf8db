/**
 * Keys as actions name them: "F", "Shift+G", "Ctrl+Z", "Esc", and as the browser tells them, whatever the layout.
 *
 * A letter is the one that is written on the key. Where the layout has other letters than Latin ones, it is the one at
 * that place on a US keyboard; digits are always those of their places, also where they need Shift.
 */

/** What the browser tells of a key. */
export interface KeyPress {
  readonly key: string;
  /** Which key of the keyboard it is, whatever is written on it; empty where that is not known. */
  readonly code: string;
  readonly altKey: boolean;
  readonly ctrlKey: boolean;
  readonly metaKey: boolean;
  readonly shiftKey: boolean;
}

const names: Readonly<Record<string, string>> = { Escape: "Esc" };

/** What actions take, by the places of keys that other letters stand on. */
const symbols: Readonly<Record<string, string>> = {
  BracketLeft: "[",
  BracketRight: "]",
  Comma: ",",
  Period: ".",
  Minus: "-",
  Equal: "=",
};

/**
 * What a press may mean, the most particular first. Shift is held to lead the hand: without a meaning
 * of its own it changes nothing. On a Mac Command is as good as Ctrl. With Alt only signs mean something,
 * which need it on some keyboards.
 *
 * @param latin whether the layout has Latin letters, as far as that was seen.
 */
export function shortcutsOf(press: KeyPress, latin = true): readonly string[] {
  const { altKey, ctrlKey, metaKey, shiftKey } = press;
  if (altKey) {
    return isSign(press.key) ? [press.key] : [];
  }
  const meant = namesOf(press, latin);
  if (ctrlKey || metaKey) {
    return meant.map((name) => `Ctrl+${shiftKey ? "Shift+" : ""}${name}`);
  }
  return shiftKey ? meant.flatMap((name) => [`Shift+${name}`, name]) : meant;
}

/** Whether a press shows that the layout has Latin letters, or others; null where it shows neither. */
export function showsLatin({ key }: Pick<KeyPress, "key">): boolean | null {
  if (!/^\p{L}$/u.test(key)) {
    return null;
  }
  return /^\p{Script=Latin}$/u.test(key);
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

/** What a key may be called, the likelier first. */
function namesOf({ key, code, shiftKey }: KeyPress, latin: boolean): readonly string[] {
  const written = names[key] ?? (key.length === 1 ? key.toUpperCase() : key);
  const digit = /^Digit(\d)$/.exec(code)?.[1];
  if (digit !== undefined) {
    // with Shift, the sign on the key is what was meant
    return shiftKey ? [written, digit] : [digit, written];
  }
  const isLatin = showsLatin({ key }) ?? latin;
  const isWritten = isLatin && !/^(Process|Dead|Unidentified)$/.test(key);
  return isWritten ? [written] : [/^Key([A-Z])$/.exec(code)?.[1] ?? symbols[code] ?? written];
}

/** Whether a key wrote a sign, and neither a letter nor a digit. */
function isSign(key: string): boolean {
  return /^[!-/:-@[-`{-~]$/.test(key);
}
