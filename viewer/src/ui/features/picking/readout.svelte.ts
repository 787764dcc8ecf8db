/**
 * What a click in the picture has found: what it is, where it stands, and the scan's value there.
 */
import { formatValue, plainPoint } from "../../../core/base/format";
import { withoutNoise } from "../../../core/scan/stored_values";
import type { PaneName } from "../../../core/view/pane";
import type { Vec3 } from "../../../core/geometry/vector";

export interface Reading {
  /** Where the click was. */
  readonly pane: PaneName;
  /** In the scene [mm]. */
  readonly point: Vec3;
  /** Of the segment there; null where the scan belongs to none. */
  readonly name: string | null;
  /** The scan's value, in its unit; null outside of it. */
  readonly value: number | null;
  /** Which of two scans is seen there. */
  readonly scan: "first" | "second";
}

/** How long a name alone stands [ms]. */
const namedTime = 4000;

export class Readout {
  shown = $state.raw<Reading | null>(null);
  /** Only its name is shown, for a while. */
  brief = $state.raw(false);

  private closing: ReturnType<typeof setTimeout> | undefined;

  /** Shows all of a reading until it is closed. */
  show(reading: Reading): void {
    this.close();
    this.shown = reading;
  }

  /** Shows the name of what was found, for a while; nothing where it has none. */
  name(reading: Reading): void {
    this.close();
    if (reading.name !== null) {
      this.shown = reading;
      this.brief = true;
      this.closing = setTimeout(() => {
        this.close();
      }, namedTime);
    }
  }

  close(): void {
    clearTimeout(this.closing);
    this.shown = null;
    this.brief = false;
  }
}

/** "−512.5 HU"; empty outside of the scan. */
export function valueText(value: number | null, scan: { readonly slope: number; readonly unit: string }): string {
  return value === null ? "" : formatValue(withoutNoise(value, scan), scan.unit);
}

/** What stands at a point as a line of text. @param rows names and values, first of what is seen. */
export function readingText(
  rows: readonly { readonly name: string; readonly text: string }[],
  point: Vec3,
  known: boolean,
): string {
  const parts = rows.flatMap(({ name, text }) => [name, text]);
  return [...parts, `${known ? "LPS" : "x y z (orientation unknown)"} ${plainPoint(point)} mm`]
    .filter((part) => part !== "")
    .join(", ");
}
