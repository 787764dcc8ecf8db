/**
 * What a person can do next with mouse and probe: the line over the picture, which stays as long as it holds.
 */
import { formatFixed } from "../base/format";
import type { Segment, ToolKind } from "../protocol";

export interface TouchSituation {
  readonly touchMode: boolean;
  /** Whether the mouse touches on the surface, and not by the hand in the view plane. */
  readonly onSurface: boolean;
  readonly presses: boolean;
  /** Whether it has pressed for a while and touches nothing. */
  readonly inVain: boolean;
  /** With how much it presses [N]. */
  readonly pressure: number;
  readonly tool: ToolKind;
  readonly segments: readonly Pick<Segment, "name" | "felt">[];
}

/** What a tool does, as X has it do. */
// @texts
const works: Readonly<Record<Exclude<ToolKind, "none" | "needle">, string>> = {
  eraser: "erases",
  adder: "adds",
  painter: "paints",
  drill: "drills",
};

/** Parts of the line, in their order. */
export function touchHint(now: TouchSituation): readonly string[] {
  const { touchMode, onSurface, presses, inVain, tool } = now;
  if (!touchMode) {
    return ["T: touch with the mouse", "double-click brings the probe there"];
  }
  const tools = tool === "none" || tool === "needle" ? [] : [`X${onSurface ? " or Shift + left" : ""} ${works[tool]}`];
  const end = "Esc leaves touch";
  if (!onSurface) {
    return ["Move the mouse to move the hand", "wheel: in depth", ...tools, end];
  }
  const pressure = `wheel: pressure ${formatFixed(now.pressure, now.pressure < 1 ? 2 : 1, "N")}`;
  if (!presses) {
    return [`Press on ${touchableName(now.segments)} to touch it`, pressure, ...tools, end];
  }
  return inVain
    ? ["Nothing that can be touched is under the pointer", end]
    : ["Drag to slide along", pressure, ...tools, "release lifts off"];
}

/** The only thing that can be touched, by its name. */
function touchableName(segments: TouchSituation["segments"]): string {
  const [only, other] = segments.filter(({ felt }) => felt);
  return only !== undefined && other === undefined ? only.name : "the picture";
}
