/**
 * Files whose layout, or the size of whose voxels, a person has to tell: raw voxels and pictures.
 */
import type { Vec3 } from "../geometry/vector";

export const numberKinds = ["uint8", "int8", "int16", "uint16", "int32", "uint32", "float32", "float64"] as const;
export type NumberKind = (typeof numberKinds)[number];
export type ByteOrder = "little" | "big";

/** How raw voxels stand in their files: x fastest, whole slices in each. */
export interface RawLayout {
  readonly columns: number;
  readonly rows: number;
  /** In all files together; null for as many as there are. */
  readonly slices: number | null;
  readonly kind: NumberKind;
  readonly order: ByteOrder;
  /** Bytes at the start of each file that are no voxels. */
  readonly skip: number;
}

/** Edges of a voxel [mm]; null where it is not known. */
export type ToldVoxel = readonly [number | null, number | null, number | null];

/** What was found where scans were looked for. */
export interface HeaderlessFiles {
  readonly find: number;
  readonly name: string;
  readonly files: number;
  /** In all files together. */
  readonly bytes: number;
  /** What is likely of raw voxels; null of pictures. */
  readonly layout: RawLayout | null;
  /** Of pictures: voxels along x, y, z. */
  readonly size: Vec3 | null;
  readonly voxel: ToldVoxel;
}

/** What a person tells of files. */
export interface GivenLayout {
  readonly layout: RawLayout | null;
  readonly voxel: ToldVoxel;
}

/** The scan that would come: its voxels along x, y, z and its middle slice. */
export interface LaidOut {
  readonly size: Vec3;
  readonly png: string;
}

/** As `palpate.read` takes a layout. */
export function layoutText({ columns, rows, slices, kind, order, skip }: RawLayout): string {
  const edges = slices === null ? [columns, rows] : [columns, rows, slices];
  return `${edges.join("x")},${kind},${order},${String(skip)}`;
}

/** All three edges, where all are given and can be. */
export function wholeVoxel([x, y, z]: ToldVoxel): Vec3 | null {
  return x !== null && y !== null && z !== null && Math.min(x, y, z) > 0 ? [x, y, z] : null;
}

/** What is kept of layouts that were given, the newest first. */
export interface KeptLayouts {
  readonly layouts: readonly (GivenLayout & { readonly of: string })[];
}

const mostKept = 12;

/** What files of one scanner have in common: bytes of a file, or pixels of a picture. */
function kindOf({ files, bytes, size }: HeaderlessFiles): string {
  return size === null ? `${String(bytes / files)} bytes` : `${String(size[0])} × ${String(size[1])} pixels`;
}

/** What is likely of files: what was given for such files before, else what the engine says. */
export function likelyOf(bare: HeaderlessFiles, { layouts }: KeptLayouts): GivenLayout {
  const kept = layouts.find(({ of }) => of === kindOf(bare));
  return kept === undefined || (kept.layout === null) !== (bare.layout === null)
    ? { layout: bare.layout, voxel: bare.voxel }
    : { layout: kept.layout, voxel: kept.voxel };
}

/** What is kept once a layout was given. */
export function withLayout({ layouts }: KeptLayouts, bare: HeaderlessFiles, told: GivenLayout): KeptLayouts {
  const of = kindOf(bare);
  return { layouts: [{ ...told, of }, ...layouts.filter((each) => each.of !== of)].slice(0, mostKept) };
}
