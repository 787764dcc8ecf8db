/**
 * What page and engine say about scans that can be opened: lists, progress, files that are dropped.
 */
import type { Projections } from "./reconstruction";
import type { Vec3 } from "./vector";

/** A scan of a list. */
export interface ListedScan {
  readonly patient: string;
  readonly study: string;
  readonly name: string;
  readonly modality: string;
  /** Voxels along x, y, z; empty where it is not known. */
  readonly size: readonly number[];
  /** [mm]; null where the files do not tell. */
  readonly spacing: Vec3 | null;
  /** Why it cannot be opened; null where it can. */
  readonly refused: string | null;
}

export interface RecentScan {
  readonly path: string;
  readonly series: string | null;
  readonly name: string;
  /** ISO 8601. */
  readonly when: string;
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
  /** What no page was told yet. */
  readonly told: readonly string[];
  readonly recent: readonly RecentScan[];
  readonly most_files: number;
  readonly most_bytes: number;
}

/** A line of what the engine tells while it works. */
export type JobLine =
  | { readonly kind: "progress"; readonly what: string; readonly share: number | null }
  | { readonly kind: "found"; readonly find: number; readonly scans: readonly ListedScan[] }
  | ({ readonly kind: "projections" } & Projections)
  | { readonly kind: "picture"; readonly choice: number; readonly png: string }
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
  return scans.length === 1 && scans[0]?.refused === null;
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
  const giga = (count: number): string => (count / 2 ** 30).toFixed(1);
  return bytes > most_bytes ? `${giga(bytes)} GiB were given; at most ${giga(most_bytes)} GiB are taken.` : null;
}
