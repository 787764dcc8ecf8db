/**
 * What page and engine say about scans that can be opened: lists, progress, files that are dropped.
 */
import { formatFixed } from "../base/format";
import type { HeaderlessFiles } from "./headerless";
import type { Projections } from "./reconstruction";
import type { Vec3 } from "../geometry/vector";

/** A scan of a list. */
export interface ListedScan {
  readonly patient: string;
  readonly study: string;
  readonly name: string;
  /** The end of its name that tells it from other volumes of its series; "" if it is alone. */
  readonly part: string;
  readonly modality: string;
  /** Voxels along x, y, z; empty where it is not known. */
  readonly size: readonly number[];
  /** [mm]; null where the files do not tell. */
  readonly spacing: Vec3 | null;
  /** Why it cannot be opened; null where it can. */
  readonly refused: string | null;
  /** What it is where it holds segments and no scan, such as "a label map". */
  readonly labels: string | null;
  /** Whether its picture only comes when it is asked for. */
  readonly late: boolean;
}

export interface RecentScan {
  readonly path: string;
  readonly series: string | null;
  /** Volume of an image file with several. */
  readonly frame: number | null;
  readonly name: string;
  /** ISO 8601. */
  readonly when: string;
  /** How raw voxels are laid out. */
  readonly raw: string | null;
  /** Where the files do not tell it [mm]. */
  readonly voxel_size: Vec3 | null;
}

/** What the engine says first. */
export interface About {
  /** Name of the open scan. */
  readonly scan: string | null;
  /** Name of what is being read, to be shown once it is. */
  readonly coming: string | null;
  /** Whether it has changes, and whether those are kept on disk. */
  readonly changed: boolean;
  readonly kept: boolean;
  readonly can_open: boolean;
  /** Messages that no page has shown yet. */
  readonly told: readonly string[];
  readonly recent: readonly RecentScan[];
  readonly most_files: number;
  readonly most_bytes: number;
}

/** Segments that were found in the place of a scan. */
export interface FoundLabels {
  readonly name: string;
  /** Such as "a label map". */
  readonly what: string;
  /** Whether it could be opened as a scan too. */
  readonly image: boolean;
}

/** What is kept of a scene whose file is damaged. */
export interface Autosave {
  /** By which it is opened; null where its scan is in no place that is known. */
  readonly find: number | null;
  /** Name of its scan. */
  readonly scan: string;
  /** ISO 8601. */
  readonly when: string;
}

/** What the engine is busy with, and how far it is. */
export interface JobProgress {
  readonly what: string;
  /** 0..1; null where it is not known. */
  readonly share: number | null;
}

/** A line of what the engine tells while it works. */
export type JobLine =
  | { readonly kind: "progress"; readonly what: string; readonly share: number | null }
  | { readonly kind: "found"; readonly find: number; readonly scans: readonly ListedScan[] }
  | ({ readonly kind: "projections" } & Projections)
  | ({ readonly kind: "bare" } & HeaderlessFiles)
  | ({ readonly kind: "labels" } & FoundLabels)
  | ({ readonly kind: "autosave" } & Autosave)
  | { readonly kind: "picture"; readonly choice: number; readonly png: string }
  | { readonly kind: "preset"; readonly preset: string; readonly png: string }
  | { readonly kind: "done" }
  | { readonly kind: "failed"; readonly reason: string };

/** Takes pieces of text and gives whole lines. */
export class Lines {
  private rest = "";

  /** Returns the lines that end in `text`. */
  take(text: string): JobLine[] {
    const lines = (this.rest + text).split("\n");
    this.rest = lines.pop() ?? "";
    return lines.filter((line) => line !== "").map((line) => JSON.parse(line) as JobLine);
  }
}

/** Whether there is nothing to choose: one scan, which can be opened. */
export function isSingle(scans: readonly ListedScan[]): boolean {
  return scans.length === 1 && scans[0]?.refused === null && scans[0].labels === null;
}

/** Scans that are one entry of a list, by their places in it: one, or many volumes of one series. */
export interface Entry {
  readonly first: number;
  readonly scans: readonly ListedScan[];
  /** What the volumes are of. */
  readonly name: string;
}

/** Volumes of one series that are listed as one. */
const leastFolded = 5;

/** Returns the entries of a list: many volumes in a row that are of one series are one. */
export function entriesOf(scans: readonly ListedScan[]): Entry[] {
  const entries: Entry[] = [];
  for (let first = 0; first < scans.length; ) {
    const key = seriesOf(scans[first]);
    let end = first + 1;
    while (key !== null && end < scans.length && seriesOf(scans[end]) === key) end += 1;
    const step = end - first < leastFolded ? 1 : end - first;
    for (; first < end; first += step) {
      entries.push({ first, scans: scans.slice(first, first + step), name: wholeName(scans[first]) });
    }
  }
  return entries;
}

/** What volumes of one series share; null of a scan that is alone. */
function seriesOf(scan: ListedScan | undefined): string | null {
  return scan === undefined || scan.part === ""
    ? null
    : [scan.patient, scan.study, scan.modality, wholeName(scan)].join("\n");
}

function wholeName(scan: ListedScan | undefined): string {
  const { name, part } = scan ?? { name: "", part: "" };
  return part === "" ? name : name.slice(0, -part.length).replace(/, $/, "");
}

/** Memory of a scan's values [bytes]. */
export function bytesOf({ size }: ListedScan): number {
  return size.length === 0 ? 0 : size.reduce((product, count) => product * count, 2);
}

/** A file that was dropped or chosen; its name has its folders, parted by "/". */
export interface GivenFile {
  readonly name: string;
  readonly file: Blob;
}

/** Why files cannot be taken; null where they can. */
export function refusalOf(files: readonly GivenFile[], { most_files, most_bytes }: About): string | null {
  const bytes = files.reduce((sum, { file }) => sum + file.size, 0);
  if (files.length === 0) {
    return "There is no file in what was dropped.";
  }
  if (files.length > most_files) {
    return `${String(files.length)} files were given; at most ${String(most_files)} are taken.`;
  }
  const giga = (count: number): string => formatFixed(count / 2 ** 30, 1, "GiB");
  return bytes > most_bytes ? `${giga(bytes)} were given; at most ${giga(most_bytes)} are taken.` : null;
}
