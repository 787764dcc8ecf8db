/**
 * Numbers as the page writes them, always with the same width and a point as decimal sign.
 */
import type { Vec3 } from "../geometry/vector";

const months = [
  "January", "February", "March", "April", "May", "June",
  "July", "August", "September", "October", "November", "December",
];

/** "-12.3 4.0 806.0" */
export function formatPoint(point: Vec3): string {
  return point.map((c) => c.toFixed(1)).join(" ");
}

/** Thin spaces between groups of three digits. */
export function formatCount(count: number): string {
  return Math.round(count)
    .toString()
    .replace(/\B(?=(\d{3})+$)/g, "\u2009");
}

/** A text with its whole numbers grouped so, as a program writes them: "1 700 ml". */
export function groupDigits(text: string): string {
  return text.replace(/(?<![\d.])\d{4,}/g, (digits) => formatCount(Number(digits)));
}

/** A value of the scan with at most six digits. */
export function formatValue(value: number): string {
  return Number(value.toPrecision(6)).toString();
}

/** A value on a scale of some span, with the digits that a 500th of the span needs. */
export function formatWithin(value: number, span: number): string {
  const digits = Math.ceil(Math.log10(500 / Math.max(span, 1e-12)));
  return value.toFixed(Math.min(Math.max(digits, 0), 9));
}

/** A volume [mm³] in three digits or whole: "36.2 mm³", "12.3 ml"; as the engine's `volume_text`. */
export function formatVolume(volume: number): string {
  if (Math.abs(volume) < 999.5) {
    return `${String(Number(volume.toPrecision(3)))} mm³`;
  }
  const ml = volume / 1000;
  return Math.abs(ml) >= 99.95 ? `${formatCount(ml)} ml` : `${ml.toPrecision(3)} ml`;
}

/** "0.90 × 0.90 × 2.50 mm" */
export function formatSpacing(spacing: Vec3): string {
  return `${spacing.map((s) => Number(s.toFixed(3)).toString()).join(" × ")} mm`;
}

export function formatBytes(bytes: number): string {
  const mega = bytes / 2 ** 20;
  return mega >= 1024 ? `${(mega / 1024).toFixed(1)} GiB` : `${mega.toFixed(0)} MiB`;
}

/** "20 November 2026, 16:34": a moment of ISO 8601, in the time of day that it names. */
export function formatMoment(iso: string): string {
  const [, year, month, day, time] = /^(\d{4})-(\d\d)-(\d\d)T(\d\d:\d\d)/.exec(iso) ?? [];
  const name = months[Number(month) - 1];
  return year === undefined || name === undefined ? iso : `${String(Number(day))} ${name} ${year}, ${time ?? ""}`;
}

/** "0:07", "12:34" */
export function formatSeconds(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  return `${Math.floor(whole / 60).toString()}:${(whole % 60).toString().padStart(2, "0")}`;
}

/** "L 12.3  P 4.0  S 806.0 mm": a point by the directions of the body, by the scan's axes where those are not known. */
export function formatPlace([x, y, z]: Vec3, known: boolean): string {
  if (!known) {
    return `x ${x.toFixed(1)}  y ${y.toFixed(1)}  z ${z.toFixed(1)} mm`;
  }
  const along = (value: number, positive: string, negative: string): string =>
    `${value < 0 ? negative : positive} ${Math.abs(value).toFixed(1)}`;
  return `${along(x, "L", "R")}  ${along(y, "P", "A")}  ${along(z, "S", "I")} mm`;
}

/** The same with a capital. */
export function capitalised(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
