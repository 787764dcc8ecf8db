/**
 * Surfaces of segments as the engine sends them: patches of triangles, in whole edits.
 *
 * What arrives is checked before anything of it is taken, so that no edit is shown by half.
 * Memory: vertices three uint16 each (0..65535 over the patch's box [mm]), normals four int8
 * each (the fourth means nothing), triangles three vertex numbers each.
 * Frame: the scene, where the scan has the segment, before the segment's pose.
 */
import type { SegmentSurface, SurfacePatch } from "../protocol";
import type { Vec3 } from "../geometry/vector";

export interface Patch {
  /** Its place in the segment's grid of patches, as a key. */
  readonly key: string;
  /** Lower corner and edges of the box that its vertices lie in [mm]. */
  readonly origin: Vec3;
  readonly size: Vec3;
  readonly vertices: Uint16Array<ArrayBuffer>;
  readonly normals: Int8Array<ArrayBuffer>;
  readonly triangles: Uint16Array<ArrayBuffer> | Uint32Array<ArrayBuffer>;
}

/** What an edit changes in one segment's surface. */
export interface SurfaceChange {
  readonly id: number;
  /** All patches held before are gone. */
  readonly whole: boolean;
  readonly dropped: readonly string[];
  readonly patches: readonly Patch[];
}

export interface SurfaceSize {
  readonly patches: number;
  readonly triangles: number;
  /** Of vertices, normals and triangles. */
  readonly bytes: number;
}

/** A patch that lies about itself. */
export class PatchError extends Error {
  override name = "PatchError";
}

/** Vertices up to which two bytes number them. */
const mostShortVertices = 65536;

const vertexBytes = 6;
const normalBytes = 4;

export function patchKey(index: Vec3): string {
  return index.join(" ");
}

/**
 * Reads what an edit changes in a segment's surface.
 *
 * @throws PatchError where a patch's lengths or vertex numbers do not fit together.
 */
export function decodeSurface(surface: SegmentSurface): SurfaceChange {
  return {
    id: surface.id,
    whole: surface.whole,
    dropped: surface.dropped.map(patchKey),
    patches: surface.patches.map((patch) => decodePatch(patch, surface.id)),
  };
}

function decodePatch(patch: SurfacePatch, segment: number): Patch {
  const key = patchKey(patch.index);
  const expect = (holds: boolean, told: string): void => {
    if (!holds) {
      throw new PatchError(`patch (${key}) of segment ${String(segment)}: ${told}`);
    }
  };
  const { vertices, normals, triangles, size } = patch;
  const [vertexLength, normalLength, triangleLength] = [vertices.length, normals.length, triangles.length];
  expect(size.every((edge) => edge >= 0), `its box has the edges ${size.join(", ")} mm; allowed: 0 and more`);
  expect(
    vertexLength % vertexBytes === 0,
    `${String(vertexLength)} bytes of vertices; allowed: ${String(vertexBytes)} each`,
  );
  const count = vertexLength / vertexBytes;
  expect(
    normalLength === normalBytes * count,
    `${String(normalLength)} bytes of normals for ${String(count)} vertices; allowed: ${String(normalBytes)} each`,
  );
  const numberBytes = count > mostShortVertices ? 4 : 2;
  expect(
    triangleLength % (3 * numberBytes) === 0,
    `${String(triangleLength)} bytes of triangles; allowed: ${String(3 * numberBytes)} each`,
  );
  const sent = numberBytes === 4 ? new Uint32Array(aligned(triangles)) : new Uint16Array(aligned(triangles));
  // the largest number of two bytes does not name a vertex for WebGL2, it ends a strip
  const numbers = count > mostShortVertices - 1 ? Uint32Array.from(sent) : sent;
  const largest = largestOf(numbers);
  expect(largest < count, `a triangle has vertex ${String(largest)} of ${String(count)}`);
  return {
    key,
    origin: patch.origin,
    size,
    vertices: new Uint16Array(aligned(vertices)),
    normals: new Int8Array(aligned(normals)),
    triangles: numbers,
  };
}

/** A copy of the bytes that begins where numbers of any size may begin, and is its own owner. */
function aligned(bytes: Uint8Array): ArrayBuffer {
  return new Uint8Array(bytes).buffer;
}

function largestOf(numbers: Uint16Array | Uint32Array): number {
  let largest = -1;
  for (const number of numbers) {
    largest = number > largest ? number : largest;
  }
  return largest;
}

/** The patches of all segments, as they are after the last edit. */
export class SurfacePatches {
  private readonly held = new Map<number, Map<string, Patch>>();

  /** Takes what an edit changes. */
  apply({ id, whole, dropped, patches }: SurfaceChange): void {
    const all = whole ? new Map<string, Patch>() : (this.held.get(id) ?? new Map<string, Patch>());
    for (const key of dropped) {
      all.delete(key);
    }
    for (const patch of patches) {
      // the engine may say of a patch that it is empty now by sending it so
      if (patch.triangles.length === 0) {
        all.delete(patch.key);
      } else {
        all.set(patch.key, patch);
      }
    }
    if (all.size === 0) {
      this.held.delete(id);
    } else {
      this.held.set(id, all);
    }
  }

  clear(): void {
    this.held.clear();
  }

  /** Segments that have a surface. */
  get ids(): readonly number[] {
    return [...this.held.keys()];
  }

  patches(id: number): readonly Patch[] {
    return [...(this.held.get(id)?.values() ?? [])];
  }

  /** The size of each segment's surface. */
  get sizes(): ReadonlyMap<number, SurfaceSize> {
    return new Map(this.ids.map((id) => [id, this.size(id)]));
  }

  private size(id: number): SurfaceSize {
    const patches = this.patches(id);
    const sum = (of: (patch: Patch) => number): number => patches.reduce((total, patch) => total + of(patch), 0);
    return {
      patches: patches.length,
      triangles: sum(({ triangles }) => triangles.length / 3),
      bytes: sum(({ vertices, normals, triangles }) => vertices.byteLength + normals.byteLength + triangles.byteLength),
    };
  }
}
