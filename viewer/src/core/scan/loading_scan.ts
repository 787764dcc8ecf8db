/**
 * A scan as it arrives, plane by plane, and what stands in for the planes that are still on their way.
 */
import { coveringRanges, noRanges, widenRanges, type BrickRanges } from "./bricks";
import { PlaneInterpolation, type CoarseScan } from "./plane_interpolation";
import { biasInPlace } from "./stored_values";
import type { Vec3 } from "../geometry/vector";

/** Bytes of planes that are handed on at once, or of one plane where that has more. */
const slabBytes = 2 * 2 ** 20;

/** Whole planes of a scan, one after the other. */
export interface Planes {
  /** Number of the first one. */
  readonly first: number;
  /** Biased values, shape [z, y, x]. */
  readonly values: Uint16Array<ArrayBuffer>;
}

/** How much of a scan can be shown. */
export interface Arrival {
  /** Planes, from the first on, whose values are their own; all others have what stands in for theirs. */
  readonly arrived: number;
  /** Ranges that cover all of these values. */
  readonly bricks: BrickRanges;
}

/** Makes whole planes of the bytes of a scan, in the order in which they come. */
export class LoadingScan {
  /** Ranges of what has arrived. */
  readonly bricks: BrickRanges;
  /** Planes that were handed on. */
  arrived = 0;
  private slab: Uint8Array<ArrayBuffer>;
  private filled = 0;

  constructor(private readonly dimensions: Vec3) {
    this.bricks = noRanges(dimensions);
    this.slab = this.nextSlab();
  }

  /** Takes the next bytes; returns what is whole by now. */
  take(bytes: Uint8Array): Planes[] {
    const whole: Planes[] = [];
    for (let from = 0; from < bytes.length; ) {
      const to = Math.min(bytes.length, from + this.slab.length - this.filled);
      this.slab.set(bytes.subarray(from, to), this.filled);
      this.filled += to - from;
      from = to;
      if (this.filled === this.slab.length) {
        whole.push(this.finishSlab());
      }
    }
    return whole;
  }

  private finishSlab(): Planes {
    const values = new Uint16Array(this.slab.buffer);
    const planes = { first: this.arrived, values };
    biasInPlace(values);
    widen(this.bricks, this.dimensions, planes);
    this.arrived += values.length / planeOf(this.dimensions);
    this.slab = this.nextSlab();
    this.filled = 0;
    return planes;
  }

  private nextSlab(): Uint8Array<ArrayBuffer> {
    const planes = Math.min(slabPlanes(this.dimensions), this.dimensions[2] - this.arrived);
    return new Uint8Array(2 * planes * planeOf(this.dimensions));
  }
}

/**
 * Makes what stands in for planes on their way from a coarse scan: the last ones first, until it meets what has
 * arrived.
 */
export class StandIn {
  private readonly between: PlaneInterpolation;
  private readonly bricks: BrickRanges;
  /** Planes from here on were made. */
  private made: number;
  /** What has arrived when it was shown last. */
  private shown = 0;
  private begun = false;

  /**
   * @param step every how many voxels the arriving scan holds a value.
   * @param parts how often it is shown until it is whole, at most.
   */
  constructor(
    coarse: CoarseScan,
    private readonly dimensions: Vec3,
    step: number,
    private readonly parts: number,
  ) {
    this.between = new PlaneInterpolation(coarse, dimensions, step);
    this.bricks = noRanges(dimensions);
    this.made = dimensions[2];
  }

  /** The next planes; null where none are missing any more. */
  make(arrived: number): Planes | null {
    if (this.made <= arrived) {
      return null;
    }
    const first = Math.max(arrived, this.made - slabPlanes(this.dimensions));
    const planes = { first, values: this.between.make(first, this.made) };
    widen(this.bricks, this.dimensions, planes);
    this.made = first;
    return planes;
  }

  /** What can be shown, where that is enough more than the last time; null else, and once the scan is whole. */
  next({ arrived, bricks }: Arrival): Arrival | null {
    const depth = this.dimensions[2];
    const more = !this.begun || arrived - this.shown >= depth / this.parts;
    if (this.made > arrived || arrived === depth || !more) {
      return null;
    }
    this.begun = true;
    this.shown = arrived;
    return { arrived, bricks: coveringRanges(bricks, this.bricks) };
  }
}

function slabPlanes(dimensions: Vec3): number {
  return Math.max(1, Math.floor(slabBytes / (2 * planeOf(dimensions))));
}

function planeOf([width, height]: Vec3): number {
  return width * height;
}

function widen(bricks: BrickRanges, dimensions: Vec3, { first, values }: Planes): void {
  const [width, height] = dimensions;
  widenRanges(bricks, { dimensions: [width, height, values.length / planeOf(dimensions)], values }, first);
}
