/**
 * Displacements of tissue from the voxels that show it, at the nodes of a box.
 * Frame: grid of the scan; displacements along its axes [mm], as half floats.
 */
import type { Displaced as Sent } from "../protocol";
import type { Vec3 } from "../geometry/vector";

export interface Displacements {
  /** First node, and from one node to the next [grid]. */
  readonly origin: Vec3;
  readonly step: Vec3;
  /** Nodes along x, y, z. */
  readonly size: Vec3;
  /** Four half floats a node, x fastest: x, y, z [mm] and nothing. */
  readonly moved: Uint16Array<ArrayBuffer>;
}

/** Half floats and bytes of a node. */
const numbers = 4;
const nodeBytes = 2 * numbers;

/** Displacements that do not fit together. */
export class DisplacementsError extends Error {
  override name = "DisplacedError";
}

/**
 * Reads displacements.
 *
 * @throws DisplacementsError where bytes are missing or the box is none.
 */
export function decodeDisplacements({ origin, step, size, moved }: Sent): Displacements {
  const nodes = size[0] * size[1] * size[2];
  if (moved.length !== nodes * nodeBytes) {
    throw new DisplacementsError(
      `${String(moved.length)} bytes of displacements for ${size.join(" x ")} nodes, ${String(nodeBytes)} each`,
    );
  }
  if (nodes === 0) {
    throw new DisplacementsError("a box of displacements has no nodes");
  }
  if (!step.every((edge) => edge > 0)) {
    throw new DisplacementsError(`nodes of displacements are ${step.join(", ")} voxels apart; allowed: more than 0`);
  }
  return { origin, step, size, moved: new Uint16Array(moved.slice().buffer) };
}
