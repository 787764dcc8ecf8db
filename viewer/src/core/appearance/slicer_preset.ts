/**
 * Reads a volume property of 3D Slicer: the JSON of a `.vp.json` file, the `<VolumeProperty …/>` element of
 * a scene or preset file, or the nine lines of a `.vp` file. Taken are the functions of opacity and of colour,
 * of the first property and component where there are more; not the lighting, nor the opacity by gradient.
 *
 * Sources: Slicer developer guide, "Volume rendering", format of volume property (.vp) file; Slicer's schema
 * `volume-property-schema-v1.0.0.json`.
 */
import type { Curve } from "./curve";
import { hexFromSrgb } from "../base/colour";

export interface SlicerPreset {
  readonly name: string;
  readonly curve: Curve;
}

/** Two points at one value are a jump: they are drawn this share of the span apart. */
const jump = 1e-4;

/** Longer texts are no preset [characters]. */
const longest = 200_000;

/**
 * @throws RangeError that says what is wrong with the text.
 */
export function readSlicerPreset(text: string): SlicerPreset {
  if (text.length > longest) {
    throw new RangeError(`a preset has at most ${String(longest)} characters, this text has ${String(text.length)}`);
  }
  if (text.trimStart().startsWith("{")) {
    return fromJson(text);
  }
  const element = /<VolumeProperty\b[^>]*>/.exec(text)?.[0];
  if (element !== undefined) {
    const attribute = (name: string): string =>
      new RegExp(`\\s${name}\\s*=\\s*["']([^"']*)["']`).exec(element)?.[1] ?? "";
    return {
      name: attribute("name").slice(0, 40) || "Imported",
      curve: fromNumbers(attribute("scalarOpacity"), attribute("colorTransfer")),
    };
  }
  const lines = text.split("\n").filter((line) => line.trim() !== "");
  if (lines.length !== 9) {
    const got = text.trim() === "" ? "nothing" : `${String(lines.length)} lines without one`;
    throw new RangeError(
      "expected the JSON of a .vp.json file, a <VolumeProperty …/> element or the 9 lines of a .vp file, " +
        `got ${got}`,
    );
  }
  return { name: "Imported", curve: fromNumbers(lines[6] ?? "", lines[8] ?? "") };
}

function fromNumbers(opacity: string, colour: string): Curve {
  return curveOf(rowsOf(opacity, 2, "scalar opacity"), rowsOf(colour, 4, "colour transfer"));
}

function fromJson(text: string): SlicerPreset {
  let told: unknown;
  try {
    told = JSON.parse(text);
  } catch (error) {
    throw new RangeError(
      `the text begins as JSON and is none: ${error instanceof Error ? error.message : String(error)}`,
      { cause: error },
    );
  }
  const component = first(part(first(part(told, "volumeProperties"), "volumeProperties"), "components"), "components");
  const rows = (
    name: string,
    what: string,
    numbers: (point: unknown) => readonly unknown[],
    columns: number,
  ): number[][] => {
    const points = part(part(component, name), "points");
    if (!Array.isArray(points) || points.length < 2) {
      throw new RangeError(`the ${what} function needs a list of at least two points as ${name}.points`);
    }
    return points.map((point, i) => {
      const row = numbers(point);
      if (row.length !== columns || !row.every((number) => typeof number === "number" && Number.isFinite(number))) {
        throw new RangeError(
          `point ${String(i + 1)} of the ${what} function needs ${String(columns)} numbers, ` +
            `got ${JSON.stringify(point)}`,
        );
      }
      return row as number[];
    });
  };
  const listed = (colour: unknown): readonly unknown[] => (Array.isArray(colour) ? colour : []);
  return {
    name: "Imported",
    curve: curveOf(
      rows("scalarOpacity", "scalar opacity", (point) => [part(point, "x"), part(point, "y")], 2),
      rows("rgbTransferFunction", "colour transfer", (point) => [part(point, "x"), ...listed(part(point, "color"))], 4),
    ),
  };
}

function part(object: unknown, name: string): unknown {
  return typeof object === "object" && object !== null
    ? (object as Readonly<Record<string, unknown>>)[name]
    : undefined;
}

function first(list: unknown, name: string): unknown {
  if (!Array.isArray(list) || list.length === 0) {
    throw new RangeError(`a volume property in JSON needs a list "${name}" that is not empty`);
  }
  return list[0];
}

function curveOf(opacity: readonly number[][], colour: readonly number[][]): Curve {
  const opacities = opacity.map(([value = 0, share = 0]) => ({ value, opacity: within("opacity", share) }));
  const colours = colour.map(([value = 0, red = 0, green = 0, blue = 0]) => ({
    value,
    colour: hexFromSrgb([within("red", red), within("green", green), within("blue", blue)]),
  }));
  return { opacities: rising(opacities, "scalar opacity"), colours: rising(colours, "colour transfer") };
}

/** Rows of a function: the first number counts those that follow. */
function rowsOf(text: string, columns: number, what: string): number[][] {
  if (text.trim() === "") {
    throw new RangeError(`the ${what} function is missing`);
  }
  const numbers = text.trim().split(/\s+/).map(Number);
  const bad = numbers.findIndex((number) => !Number.isFinite(number));
  if (bad >= 0) {
    throw new RangeError(`the ${what} function holds "${text.trim().split(/\s+/)[bad] ?? ""}", which is no number`);
  }
  const [count = 0, ...values] = numbers;
  if (count !== values.length || count % columns !== 0 || count < 2 * columns) {
    throw new RangeError(
      `the ${what} function says ${String(count)} numbers and has ${String(values.length)}; ` +
        `it needs ${String(columns)} for each of at least two points`,
    );
  }
  return Array.from({ length: count / columns }, (_, row) => values.slice(row * columns, (row + 1) * columns));
}

function within(what: string, share: number): number {
  if (share < 0 || share > 1) {
    throw new RangeError(`${what} goes from 0 to 1, got ${String(share)}`);
  }
  return share;
}

/** Rows by rising value; jumps get a slope of their own. */
function rising<T extends { readonly value: number }>(rows: readonly T[], what: string): T[] {
  const sorted = [...rows].sort((a, b) => a.value - b.value);
  const span = (sorted.at(-1)?.value ?? 0) - (sorted[0]?.value ?? 0);
  if (!(span > 0)) {
    throw new RangeError(`the ${what} function has all its points at one value`);
  }
  let last = -Infinity;
  return sorted.map((row) => {
    last = Math.max(row.value, last + span * jump);
    return { ...row, value: last };
  });
}
