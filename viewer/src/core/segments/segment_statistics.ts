/**
 * Statistics of segments as the engine reports them: a table for people, and the same as CSV.
 */
import { groupDigits } from "../base/format";

export interface StatisticsTable {
  /** Headings with units, then a row for each segment: its name, numbers, and what is missing. */
  readonly cells: readonly (readonly string[])[];
  readonly csv: string;
  /** What is to be known of how they were measured. */
  readonly notes: readonly string[];
}

/**
 * Returns the table as a narrow panel shows it: a column for each segment, digits in groups.
 *
 * Rows without a heading tell what is missing; they stay only where something is.
 */
export function shownCells(cells: StatisticsTable["cells"]): string[][] {
  const [headings = [], ...segments] = cells;
  return headings
    .map((heading, row) => {
      // names stay as they are
      const told = segments.map((segment) => (row === 0 ? segment[row] ?? "" : groupDigits(segment[row] ?? "")));
      return [heading, ...told];
    })
    .filter(([heading, ...told]) => heading !== "" || told.some((each) => each !== ""));
}

type Line =
  | ({ readonly kind: "statistics" } & StatisticsTable)
  | { readonly kind: "failed"; readonly reason: string }
  | { readonly kind: "progress" | "done" };

/** Returns the table among the lines of an answer. Throws why there is none. */
export function statisticsOf(answer: string): StatisticsTable {
  for (const text of answer.split("\n").filter((each) => each !== "")) {
    const line = JSON.parse(text) as Line;
    if (line.kind === "failed") {
      throw new Error(line.reason);
    }
    if (line.kind === "statistics") {
      return line;
    }
  }
  throw new Error("the engine's answer was cut off");
}
