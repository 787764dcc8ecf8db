import { expect, test } from "vitest";
import { statisticsOf } from "../../../src/core/segments/segment_statistics";

const progress = '{"kind":"progress","what":"measuring bone","share":0.0}\n';

test("the table is found among the lines of an answer", () => {
  const table = { cells: [["segment", "volume"], ["bone", "813 ml"]], csv: "segment\nbone\n", notes: [] };
  const answer = `${progress}${JSON.stringify({ kind: "statistics", ...table })}\n{"kind":"done"}\n`;
  expect(statisticsOf(answer)).toMatchObject(table);
});

test("why there is none is told", () => {
  expect(() => statisticsOf(`${progress}{"kind":"failed","reason":"segments came or went"}\n`)).toThrow(
    "segments came or went",
  );
  expect(() => statisticsOf(progress)).toThrow("cut off");
});
