/**
 * Marks that a person sets on a scan: single points, distances, angles, areas and planned paths of a needle, and what
 * they measure.
 *
 * Frame: scene, LPS [mm]; angles [rad].
 */
import { formatArea, type AreaValues } from "./area_values";
import { areaKinds, areaOutline, areaSize, draggedArea, isArea } from "./area";
import { deepEqual } from "../base/deep_equal";
import { formatFixed } from "../base/format";
import { distance, dot, isPoint, length, subtract, type Vec3 } from "../geometry/vector";

export const markKinds = ["point", "distance", "angle", "path", ...areaKinds] as const;
export type MarkKind = (typeof markKinds)[number];

export interface Mark {
  readonly id: number;
  readonly kind: MarkKind;
  readonly name: string;
  /**
   * In the order in which they were set; of an angle the second is its vertex, of a path of a needle its target comes
   * first; of an area its middle and the ends of two half axes.
   */
  readonly points: readonly Vec3[];
  readonly visible: boolean;
}

/** Points that make a mark whole. */
export const pointsOf: Readonly<Record<MarkKind, number>> = {
  point: 1,
  distance: 2,
  angle: 3,
  path: 2,
  ellipse: 3,
  rectangle: 3,
};

const kindNames: Readonly<Record<MarkKind, string>> = {
  point: "Point",
  distance: "Distance",
  angle: "Angle",
  path: "Needle path",
  ellipse: "Ellipse",
  rectangle: "Rectangle",
};

/** Longer names are cut. */
const longestName = 80;

/** A number that no other page gives to a mark at the same time. */
export function newMarkId(): number {
  return (crypto.getRandomValues(new Uint32Array(1))[0] ?? 0) + 1;
}

/** Marks with one more, named after its kind. */
export function withMark(
  marks: readonly Mark[],
  kind: MarkKind,
  points: readonly Vec3[],
  id = newMarkId(),
): readonly Mark[] {
  const names = new Set(marks.map(({ name }) => name));
  let number = 1;
  while (names.has(`${kindNames[kind]} ${String(number)}`)) {
    number += 1;
  }
  return [...marks, { id, kind, name: `${kindNames[kind]} ${String(number)}`, points, visible: true }];
}

export function withoutMark(marks: readonly Mark[], id: number): readonly Mark[] {
  return marks.filter((mark) => mark.id !== id);
}

/** What differs: numbers of marks, each with what it is by now, or null where it was removed. */
export function markChanges(
  before: readonly Mark[],
  now: readonly Mark[],
): readonly (readonly [number, Mark | null])[] {
  const was = new Map(before.map((mark) => [mark.id, mark]));
  const is = new Map(now.map((mark) => [mark.id, mark]));
  return [...new Set([...was.keys(), ...is.keys()])]
    .filter((id) => !deepEqual(was.get(id), is.get(id)))
    .map((id) => [id, is.get(id) ?? null]);
}

/** Marks of which one is changed in part. An empty name keeps the one before. */
export function changedMark(
  marks: readonly Mark[],
  id: number,
  part: Partial<Pick<Mark, "name" | "visible" | "points">>,
): readonly Mark[] {
  const name = (part.name ?? "").trim().slice(0, longestName);
  return marks.map((mark) => (mark.id === id ? { ...mark, ...part, name: name === "" ? mark.name : name } : mark));
}

/** Marks of which one point stands elsewhere. */
export function withPointAt(marks: readonly Mark[], id: number, index: number, point: Vec3): readonly Mark[] {
  const mark = marks.find((each) => each.id === id);
  const points = mark?.points ?? [];
  const moved =
    mark !== undefined && isArea(mark.kind)
      ? draggedArea(points, index, point)
      : points.map((other, i) => (i === index ? point : other));
  return changedMark(marks, id, { points: moved });
}

/** Angle at a vertex between the ways to two points [rad]; 0 where one of them is the vertex itself. */
export function angleAt(vertex: Vec3, a: Vec3, b: Vec3): number {
  const [toA, toB] = [subtract(a, vertex), subtract(b, vertex)];
  const size = length(toA) * length(toB);
  // rounding can lead out of what has an arc cosine
  return size > 0 ? Math.acos(Math.min(1, Math.max(-1, dot(toA, toB) / size))) : 0;
}

/** The line of a mark in space: from point to point, or around an area and back. */
export function lineOf({ kind, points }: Pick<Mark, "kind" | "points">): readonly Vec3[] {
  if (!isArea(kind) || points.length < pointsOf[kind]) {
    return points;
  }
  const outline = areaOutline(kind, points);
  return [...outline, ...outline.slice(0, 1)];
}

/** What it measures: a length [mm], an angle [rad], an area [mm²]; nothing of a point or while points are missing. */
export function measured({ kind, points }: Pick<Mark, "kind" | "points">): number | null {
  const [first, second, third] = points;
  if ((kind === "distance" || kind === "path") && first !== undefined && second !== undefined) {
    return distance(first, second);
  }
  if (kind === "angle" && first !== undefined && second !== undefined && third !== undefined) {
    return angleAt(second, first, third);
  }
  return isArea(kind) && third !== undefined ? areaSize(kind, points) : null;
}

const degrees = (angle: number): number => (angle * 180) / Math.PI;

/** "12.3 mm", "47.1°", "312 mm²"; empty where nothing is measured. */
export function formatMeasured(mark: Pick<Mark, "kind" | "points">): string {
  const value = measured(mark);
  if (value === null) {
    return "";
  }
  if (isArea(mark.kind)) {
    return formatArea(value);
  }
  return mark.kind === "angle" ? `${degrees(value).toFixed(1)}°` : formatFixed(value, 1, "mm");
}

/** What the engine has measured of an area; null where it has not. */
export type ValuesOf = (mark: Mark) => AreaValues | null;

/**
 * A table of marks for a spreadsheet (RFC 4180): a line each, lengths in mm, angles in degrees, areas in mm² with the
 * values inside; places along the scan's own axes where the sides of the body are not known.
 *
 * @param unit of the scan's values; empty where there is none.
 */
export function marksTable(marks: readonly Mark[], known: boolean, unit = "", valuesOf: ValuesOf = () => null): string {
  const ofValues = unit === "" ? "" : ` (${unit})`;
  const axes = known ? ["L", "P", "S"] : ["x", "y", "z"];
  const head = [
    "name",
    "kind",
    "value",
    "unit",
    ...[1, 2, 3].flatMap((i) => axes.map((axis) => `${axis}${String(i)} (mm)`)),
    ...["mean", "SD", "min", "max"].map((name) => `${name}${ofValues}`),
    "voxels",
  ];
  const rows = marks.map((mark) => {
    const value = measured(mark);
    const number = value === null ? "" : (mark.kind === "angle" ? degrees(value) : value).toFixed(2);
    const measures = value === null ? "" : mark.kind === "angle" ? "deg" : isArea(mark.kind) ? "mm2" : "mm";
    const inside = isArea(mark.kind) ? valuesOf(mark) : null;
    const values = [inside?.mean, inside?.standard_deviation, inside?.minimum, inside?.maximum, inside?.count];
    const places = [0, 1, 2].flatMap((i) => mark.points[i]?.map((c) => c.toFixed(2)) ?? ["", "", ""]);
    const told = values.map((each) => (each === undefined || each === null ? "" : String(Number(each.toPrecision(9)))));
    return [mark.name, mark.kind, number, measures, ...places, ...told];
  });
  return [head, ...rows].map((row) => `${row.map(cell).join(",")}\r\n`).join("");
}

function cell(text: string): string {
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** The mark that was kept under a number; none where it is none: files may hold anything. */
export function saneMark(given: unknown, id: number): readonly Mark[] {
  if (typeof given !== "object" || given === null) {
    return [];
  }
  const { kind: wanted, name, points, visible } = given as Partial<Record<keyof Mark, unknown>>;
  const kind = markKinds.find((known) => known === wanted);
  if (
    kind === undefined ||
    typeof name !== "string" ||
    !Array.isArray(points) ||
    points.length !== pointsOf[kind] ||
    !points.every(isPoint)
  ) {
    return [];
  }
  return [{ id, kind, name: name.slice(0, longestName), points, visible: visible !== false }];
}
