/**
 * Numbers as the page writes them: a point as decimal sign, a true minus, and a narrow space before the unit.
 * Fields in which a person types take plain numbers instead.
 */
import type { Vec3 } from "../geometry/vector";

/** Stands between a number and its unit; no line ends there. */
const narrowSpace = "\u202f";
/** Stands between groups of digits. */
const thinSpace = "\u2009";
const trueMinus = "\u2212";

/** A number as programs write it, with a true minus instead of a hyphen. */
function withTrueMinus(number: string): string {
  return number.replace(/-(?=\d)/g, trueMinus);
}

/** A unit after a number, with the space between them; nothing where there is none. */
export function afterNumber(unit: string): string {
  return unit === "" ? "" : `${narrowSpace}${unit}`;
}

/** A number with so many digits after the point, and its unit: "−12.3 mm". */
export function formatFixed(value: number, digits: number, unit = ""): string {
  return `${withTrueMinus(value.toFixed(digits))}${afterNumber(unit)}`;
}

/** "30 %" of a share 0.3 */
export function formatPercent(share: number, digits = 0): string {
  return formatFixed(100 * share, digits, "%");
}

/**
 * "1 seed", "2 seeds": a number with one of the forms of its word, in English one and several. In another language the
 * build gives its forms, and which of them a number takes.
 */
export function plural(count: number, forms: readonly string[], formOf = englishForm): string {
  return `${formatCount(count)} ${forms[formOf(count)] ?? forms[0] ?? ""}`;
}

function englishForm(count: number): number {
  return count === 1 ? 0 : 1;
}

/** "−12.3 4.0 806.0" */
export function formatPoint(point: Vec3): string {
  return point.map((c) => formatFixed(c, 1)).join(" ");
}

/** The same for programs: "-12.3 4.0 806.0". */
export function plainPoint(point: Vec3): string {
  return point.map((c) => c.toFixed(1)).join(" ");
}

/** Thin spaces between groups of three digits. */
export function formatCount(count: number): string {
  return Math.round(count)
    .toString()
    .replace(/\B(?=(\d{3})+$)/g, thinSpace);
}

/** A text of the page for other programs: its numbers with a hyphen as minus, ungrouped, and with usual spaces. */
export function plainText(text: string): string {
  return text
    .replaceAll(trueMinus, "-")
    .replace(new RegExp(`(?<=\\d)${thinSpace}(?=\\d)`, "g"), "")
    .replace(new RegExp(`[${thinSpace}${narrowSpace}]`, "g"), " ");
}

/** A text with its whole numbers grouped so, as a program writes them: "1 700 ml". */
export function groupDigits(text: string): string {
  return text.replace(/(?<![\d.])\d{4,}/g, (digits) => formatCount(Number(digits)));
}

/** A value of the scan with at most six digits, and its unit. */
export function formatValue(value: number, unit = ""): string {
  return `${withTrueMinus(Number(value.toPrecision(6)).toString())}${afterNumber(unit)}`;
}

/** A value on a scale of some span, with the digits that a 500th of the span needs. */
export function formatWithin(value: number, span: number): string {
  const digits = Math.ceil(Math.log10(500 / Math.max(span, 1e-12)));
  return formatFixed(value, Math.min(Math.max(digits, 0), 9));
}

/** A volume [mm³] in three digits or whole: "36.2 mm³", "12.3 ml"; as the engine's `volume_text`. */
export function formatVolume(volume: number): string {
  if (Math.abs(volume) < 999.5) {
    return `${String(Number(volume.toPrecision(3)))}${afterNumber("mm³")}`;
  }
  const ml = volume / 1000;
  return `${Math.abs(ml) >= 99.95 ? formatCount(ml) : ml.toPrecision(3)}${afterNumber("ml")}`;
}

/** "0.90 × 0.90 × 2.50 mm" */
export function formatSpacing(spacing: Vec3): string {
  return `${spacing.map((s) => Number(s.toFixed(3)).toString()).join(" × ")}${afterNumber("mm")}`;
}

export function formatBytes(bytes: number): string {
  const mega = bytes / 2 ** 20;
  return mega >= 1024 ? formatFixed(mega / 1024, 1, "GiB") : formatFixed(mega, 0, "MiB");
}

/** "2000-01-01, 16:34": a moment of ISO 8601, in the time of day that it names. */
export function formatMoment(iso: string): string {
  const [, date, time] = /^(\d{4}-\d\d-\d\d)T(\d\d:\d\d)/.exec(iso) ?? [];
  return date === undefined || time === undefined ? iso : `${date}, ${time}`;
}

/** "16:34": the time of day that a moment of ISO 8601 names. */
export function timeOf(iso: string): string {
  return /T(\d\d:\d\d)/.exec(iso)?.[1] ?? iso;
}

/** "0:07", "12:34" */
export function formatSeconds(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  return `${Math.floor(whole / 60).toString()}:${(whole % 60).toString().padStart(2, "0")}`;
}

/** "L 12.3  P 4.0  S 806.0 mm": a point by the directions of the body, by the scan's axes where those are not known. */
export function formatPlace([x, y, z]: Vec3, known: boolean): string {
  if (!known) {
    return `x ${formatFixed(x, 1)}  y ${formatFixed(y, 1)}  z ${formatFixed(z, 1, "mm")}`;
  }
  const along = (value: number, positive: string, negative: string): string =>
    `${value < 0 ? negative : positive} ${Math.abs(value).toFixed(1)}`;
  return `${along(x, "L", "R")}  ${along(y, "P", "A")}  ${along(z, "S", "I")}${afterNumber("mm")}`;
}

/** The same with a capital. */
export function capitalised(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** The engine's sentences begin small, as on the command line; a file's name stays as it is. */
export function begunLarge(text: string): string {
  return /^[a-z]+(?=[\s,;:]|$)/.test(text) ? capitalised(text) : text;
}

/** A sentence of the engine, which has no point at its end, as people write it. */
export function asSentence(text: string): string {
  return begunLarge(/[.!?…]$/.test(text) ? text : `${text}.`);
}
