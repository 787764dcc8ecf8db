/**
 * Marks as a file of 3D Slicer's Markups module (`.mrk.json`), which it opens by dropping it on its window.
 *
 * Positions are LPS [mm], as the file says. Points become one list, distances and needle paths lines, angles angles;
 * areas, which Slicer has none of, become closed curves through their outlines.
 *
 * Source: Slicer, "Markups JSON file format", schema 1.0.3 (Modules/Loadable/Markups/Resources/Schema).
 */
import { areaOutline, isArea } from "./area";
import { formatMeasured, type Mark } from "./measure";
import type { Vec3 } from "../geometry/vector";

const schema =
  "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#";

type MarkupType = "Fiducial" | "Line" | "Angle" | "ClosedCurve";

interface NamedPoint {
  readonly label: string;
  readonly description?: string;
  readonly position: Vec3;
  readonly visible: boolean;
}

/** @param told what else is told of a mark, as of the values in an area. */
export function slicerMarkups(marks: readonly Mark[], told: (mark: Mark) => string = () => ""): string {
  const points = marks.filter(({ kind }) => kind === "point");
  const list = points.map(({ name, points: [position = [0, 0, 0]], visible }) => ({ label: name, position, visible }));
  const others = marks
    .filter(({ kind }) => kind !== "point")
    .map((mark) => markup(typeOf(mark), mark.name, pointsOfMark(mark, told(mark)), mark.visible));
  const markups = [...(list.length > 0 ? [markup("Fiducial", "Points", list, true)] : []), ...others];
  return `${JSON.stringify({ "@schema": schema, markups }, null, 2)}\n`;
}

function typeOf({ kind }: Mark): MarkupType {
  return isArea(kind) ? "ClosedCurve" : kind === "angle" ? "Angle" : "Line";
}

function pointsOfMark(mark: Mark, told: string): readonly NamedPoint[] {
  const { kind, name, points } = mark;
  const places = isArea(kind) ? areaOutline(kind, points) : points;
  const description = [formatMeasured(mark), told].filter((text) => text !== "").join("; ");
  return places.map((position, i) => ({
    label: `${name}-${String(i + 1)}`,
    ...(i === 0 ? { description } : {}),
    position,
    visible: true,
  }));
}

function markup(type: MarkupType, name: string, points: readonly NamedPoint[], visible: boolean): object {
  return {
    type,
    name,
    coordinateSystem: "LPS",
    coordinateUnits: "mm",
    locked: false,
    controlPoints: points.map(({ label, description = "", position, visible: seen }, i) => ({
      id: String(i + 1),
      label,
      description,
      position,
      visibility: seen,
      // else versions from 2022 on take them as not placed yet
      positionStatus: "defined",
    })),
    display: { visibility: visible, pointLabelsVisibility: type === "Fiducial" },
  };
}
