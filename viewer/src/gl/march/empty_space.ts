/**
 * Which bricks hold something drawn, and how far a ray may leap over the others: kept in step with
 * the scan's values, its labels and its appearance.
 */
import type * as THREE from "three";
import { boundsOf, distanceToFilled, filledBricks, type BrickRanges } from "../../core/scan/bricks";
import type { Drawn } from "../../core/appearance/drawn_values";
import { bricksReadingBox, forEachCell, type Box } from "../../core/scan/voxel_change";
import { byteTexture } from "../textures/lookup_textures";

export class EmptySpace {
  private bricks: BrickRanges | null = null;
  private labelled: Uint8Array | null = null;
  private drawn: Drawn | null = null;
  /** Bricks that hold something drawn. */
  private filled: Uint8Array | null = null;
  /** Their bounds, once they were asked for. */
  private found: ReturnType<typeof boundsOf> = null;

  constructor(private readonly uniform: { value: THREE.Texture | null }) {}

  setBricks(bricks: BrickRanges): void {
    this.bricks = bricks;
    this.fill();
  }

  setDrawn(drawn: Drawn): void {
    this.drawn = drawn;
    this.fill();
  }

  /** Bricks that hold voxels of segments that are no threshold; null where there are none. */
  setLabelled(labelled: Uint8Array | null): void {
    if (labelled !== this.labelled) {
      this.labelled = labelled;
      this.fill();
    }
  }

  /** Values or labels of a box have changed, their bricks with them; what follows is uploaded. */
  change(box: Box, renderer: THREE.WebGLRenderer): void {
    const { bricks, drawn, filled, labelled } = this;
    if (bricks === null || drawn === null || filled === null) {
      return;
    }
    let same = true;
    forEachCell(bricksReadingBox(box, bricks.counts), bricks.counts, (i) => {
      const full = drawn.any(bricks.low[i] ?? 0, bricks.high[i] ?? 0) || labelled?.[i] === 1 ? 1 : 0;
      same &&= filled[i] === full;
      filled[i] = full;
    });
    if (!same) {
      this.measure();
      const { value: texture } = this.uniform;
      if (texture !== null) {
        renderer.initTexture(texture);
      }
    }
  }

  /** The first and the last brick along each axis that hold something drawn; null where none does. */
  get bounds(): ReturnType<typeof boundsOf> {
    return this.filled === null || this.bricks === null
      ? null
      : (this.found ??= boundsOf(this.filled, this.bricks.counts));
  }

  dispose(): void {
    this.uniform.value?.dispose();
  }

  private fill(): void {
    const { bricks, drawn } = this;
    if (bricks !== null && drawn !== null) {
      const filled = filledBricks(bricks, (low, high) => drawn.any(low, high));
      this.filled = filled.map((full, i) => full | (this.labelled?.[i] ?? 0));
      this.measure();
    }
  }

  /** Tells the shader how far it may leap. */
  private measure(): void {
    this.found = null;
    if (this.filled !== null && this.bricks !== null) {
      const { counts } = this.bricks;
      this.uniform.value?.dispose();
      this.uniform.value = byteTexture(distanceToFilled(this.filled, counts), counts);
    }
  }
}
