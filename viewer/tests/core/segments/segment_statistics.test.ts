import { expect, test } from "vitest";
import { shownCells, statisticsOf } from "../../../src/core/segments/segment_statistics";

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

test("segments are columns, and digits stand in groups as in the rows beside", () => {
  const headings = ["segment", "volume", "voxels", "min to max [HU]", "centroid L, P, S [mm]", ""];
  const bone = ["bone 12345", "1700 ml", "3882465", "-1024 to 3071.5", "12.3, -45.6, 1806.0", ""];
  const rows = shownCells([headings, bone, ["dot", "1.23456 mm³", "1", "–", "0.0, 0.0, 0.0", ""]]);
  expect(rows).toEqual([
    ["segment", "bone 12345", "dot"],
    ["volume", "1\u2009700 ml", "1.23456 mm³"],
    ["voxels", "3\u2009882\u2009465", "1"],
    ["min to max [HU]", "-1\u2009024 to 3\u2009071.5", "–"],
    ["centroid L, P, S [mm]", "12.3, -45.6, 1\u2009806.0", "0.0, 0.0, 0.0"],
  ]);
  const noted = shownCells([headings, [...bone.slice(0, 5), "no values"]]);
  expect(noted.at(-1)).toEqual(["", "no values"]);
});
