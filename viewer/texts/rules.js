/**
 * Which strings of the page's code are texts that people read: by where a string stands, and by its shape. Names of
 * the protocol, classes, ids, keys, units and what goes into files are none.
 *
 * Where a rule is wrong for one place, that place says so: "@texts" in the comment before a declaration makes all its
 * strings texts, and a string after a comment of the one word "@text" is one.
 */

/** Attributes, and properties of components, that are read. */
const readAttributes = new Set([
  ...["alt", "aria-label", "aria-roledescription", "aria-valuetext", "label", "placeholder", "title"],
  ...["drawnBy", "said", "shown", "text", "what"],
]);

/** Fields of objects that are read, whatever their shape. */
const readFields = new Set([
  ...["does", "label", "meaning", "note", "refused", "says", "section", "short", "text", "title", "what", "words"],
]);

/** Fields of objects that no one reads. */
const unreadFields = new Set([
  ...["accept", "at", "coordinateSystem", "font", "format", "group", "hash", "key", "kind", "method", "type", "unit"],
  ...["pointLabelsVisibility", "powerPreference"],
]);

/** Variables of which no one reads the value: groups of actions, and a preset beside those of 3D Slicer. */
const unreadNames = /^(anatomy|group|named)$/;

/** Functions whose arguments are names for the browser, for the protocol or for files, or numbers with a unit. */
const unreadCalls = ending([
  ...["querySelector(All)?", "closest", "matches", "matchMedia", "getElementById", "createElement", "getPropertyValue"],
  ...["getModifierState", "(add|remove)EventListener", "[gs]etAttribute", "getContext", "getExtension", "startsWith"],
  ...["endsWith", "includes", "indexOf", "has", "get", "glob", "searchParams\\.set", "replace(All)?", "defineProperty"],
  ...["apiAddress", "fetch", "fetchFile", "importKey", "sign", "oneOf", "expect", "column", "markup", "isForControl"],
  ...["DOMException", "RegExp", "Map", "ProtocolError", "PatchError", "DisplacementsError", "seen", "recall"],
  ...["remember", "themeColour", "srgbFromHex", "formatFixed", "formatValue", "afterNumber"],
]);

/** Functions whose arguments are texts, be they one small word. */
const readCalls = ending(["this\\.set", "state\\.change", "join"]);

/** A key of the keyboard, as browsers name it or as the page shows it. */
const keys = new RegExp(
  "^((Ctrl|Shift|Alt)\\+.*|Enter|Esc(ape)?|Space|Backspace|Delete|Insert|Tab|Home|End|AltGraph|Page(Up|Down)" +
    "|Arrow\\w+)$",
);

/** What is written for programs. */
const code = [
  // selectors and values of style sheets, fonts, paths, shaders
  /^[.#[\n]|;\n|:not\(|, \.|px( |$)|^[\w-]+[([]|^\w+:\/\/|^\/\w|^--/,
  // names of errors, abbreviations, units, heads of columns
  /^\w+Error$|^[A-Z]{2,}$|^([kMG]?(Pa|Hz)|[MG]iB|\{\} [cm]m)$|\((mm3?|s|N|mJ)\)$/,
];

/** Whether a text of the page's markup is for people. */
export function isReadText(text) {
  return /\p{L}{2}/u.test(text);
}

/** Whether an attribute is for people. */
export function isReadAttribute(name) {
  return readAttributes.has(name);
}

/**
 * Whether a string of the code is for people. `place` is where it ends up, see places.js; `text` has "{}" for each
 * part that is put in.
 */
export function isRead(text, place) {
  if (!/\p{L}{2}/u.test(text) || keys.test(text) || code.some((each) => each.test(text))) {
    return false;
  }
  switch (place.kind) {
    case "word":
      return false;
    case "told":
    case "markup":
      return true;
    case "attribute":
      return readAttributes.has(place.name);
    case "field":
      return readFields.has(place.name) ? !isId(text) : !unreadFields.has(place.name) && isSentence(text);
    case "call":
      return !unreadCalls.test(place.name) && (isSentence(text) || readCalls.test(place.name));
    case "variable":
      return !unreadNames.test(place.name) && isSentence(text);
    default:
      return isSentence(text);
  }
}

/** Several words, one with a capital, or one beside what is put in. */
function isSentence(text) {
  return /\p{L}\S*\s+\S*\p{L}|^\p{Lu}[-\p{Ll}]|\{\}\S*\s|\s\S*\{\}/u.test(text);
}

/** Names such as "keep-largest" and "open_scan". */
function isId(text) {
  return /^[a-z0-9]+([-_][a-z0-9]+)+$/.test(text);
}

function ending(names) {
  return new RegExp(`(^|\\.)(${names.join("|")})$`);
}
