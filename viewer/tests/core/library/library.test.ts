/** Lists of scans: lines that come in pieces, what needs no choice, what is too much to take. */
import { expect, test } from "vitest";
import {
  bytesOf,
  entriesOf,
  isSingle,
  Lines,
  refusalOf,
  type About,
  type ListedScan,
} from "../../../src/core/library/library";

const scan: ListedScan = {
  patient: "",
  study: "",
  name: "thin",
  part: "",
  modality: "CT",
  size: [4, 3, 5],
  spacing: [1, 1, 2],
  refused: null,
  labels: null,
  late: false,
};
const about: About = {
  scan: null,
  coming: null,
  changed: false,
  kept: true,
  can_open: true,
  told: [],
  recent: [],
  most_files: 2,
  most_bytes: 10,
};

test("lines are whole however they come", () => {
  const lines = new Lines();
  expect(lines.take('{"kind":"progress","what":"look')).toEqual([]);
  expect(lines.take('ing","share":0.5}\n{"kind":"done"}\n{"k')).toEqual([
    { kind: "progress", what: "looking", share: 0.5 },
    { kind: "done" },
  ]);
  expect(lines.take('ind":"failed","reason":"no"}\n')).toEqual([{ kind: "failed", reason: "no" }]);
});

test("one scan that can be opened needs no choice", () => {
  expect(isSingle([scan])).toBe(true);
  expect(isSingle([scan, scan])).toBe(false);
  expect(isSingle([{ ...scan, refused: "it is flat" }])).toBe(false);
  expect(isSingle([{ ...scan, labels: "a label map" }])).toBe(false);
  expect(isSingle([])).toBe(false);
});

test("memory is that of 16-bit values", () => {
  expect(bytesOf(scan)).toBe(120);
  expect(bytesOf({ ...scan, size: [] })).toBe(0);
});

test("too many files, too many bytes and none are refused before they are brought", () => {
  const file = (bytes: number) => ({ name: "a", file: new Blob([new Uint8Array(bytes)]) });
  expect(refusalOf([file(5), file(5)], about)).toBeNull();
  expect(refusalOf([file(5), file(6)], about)).toContain("at most 0.0\u202fGiB");
  expect(refusalOf([file(1), file(1), file(1)], about)).toContain("3 files were given; at most 2");
  expect(refusalOf([], about)).toContain("no file");
});

test("many volumes of one series are one entry, few are not", () => {
  const volumes = (name: string, count: number): ListedScan[] =>
    Array.from({ length: count }, (_, i) => ({
      ...scan,
      name: `${name}, direction ${String(i)}`,
      part: `direction ${String(i)}`,
    }));
  const listed = [scan, ...volumes("DTI", 64), scan, ...volumes("DTI", 4), ...volumes("other", 5)];
  const entries = entriesOf(listed);
  expect(entries.map(({ first, scans }) => [first, scans.length])).toEqual([
    [0, 1], [1, 64], [65, 1], [66, 1], [67, 1], [68, 1], [69, 1], [70, 5],
  ]);
  expect(entries.map(({ name }) => name)).toEqual(["thin", "DTI", "thin", "DTI", "DTI", "DTI", "DTI", "other"]);
  expect(entriesOf([])).toEqual([]);
});
