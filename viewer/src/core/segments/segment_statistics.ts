/**
 * Statistics of segments as the engine reports them: a table for people, and the same as CSV.
 */

export interface StatisticsTable {
  /** Headings with units, then a row for each segment: its name, numbers, and what is missing. */
  readonly cells: readonly (readonly string[])[];
  readonly csv: string;
  /** What is to be known of how they were measured. */
  readonly notes: readonly string[];
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
