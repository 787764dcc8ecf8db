/**
 * Planes of a scan from one that is held more coarsely: what stands for values that have not arrived yet.
 *
 * Cubic along each axis, one axis after the other: through the coarse values, and with their central differences
 * as slopes. So such a plane has the values and the gradients with which the coarse scan itself is drawn.
 *
 * Source: Catmull & Rom, "A class of local interpolating splines", Computer Aided Geometric Design (1974).
 */
import type { Vec3 } from "../geometry/vector";
import { largest, type StoredVolume } from "./stored_values";

export interface CoarseScan extends StoredVolume {
  /** Every how many voxels along each axis a value is held. */
  readonly step: number;
}

/** Which four samples a value lies between, and the weight of each. */
interface Between {
  readonly samples: readonly [number, number, number, number];
  readonly weights: readonly [number, number, number, number];
}

export class PlaneInterpolation {
  private readonly columns: readonly Between[];
  private readonly rows: readonly Between[];
  private readonly depths: readonly Between[];
  private readonly plane: number;
  /** Coarse planes as wide and as high as fine ones: the last that were asked for. */
  private readonly widened = new Map<number, Float32Array>();

  /**
   * @param dimensions of the fine scan.
   * @param step every how many voxels it holds a value.
   */
  constructor(
    private readonly coarse: CoarseScan,
    dimensions: Vec3,
    step: number,
  ) {
    const along = (axis: 0 | 1 | 2): Between[] =>
      Array.from({ length: dimensions[axis] }, (_, i) =>
        betweenSamples((i * step) / coarse.step, coarse.dimensions[axis]),
      );
    this.columns = along(0);
    this.rows = along(1);
    this.depths = along(2);
    this.plane = dimensions[0] * dimensions[1];
  }

  /** Biased values of planes `from` up to, but without, `to`; neighbours one after the other cost least. */
  make(from: number, to: number): Uint16Array<ArrayBuffer> {
    const values = new Uint16Array(this.plane * (to - from));
    // from behind, as those who ask do
    for (let z = to - 1; z >= from; --z) {
      this.fill(values.subarray(this.plane * (z - from), this.plane * (z - from + 1)), z);
    }
    return values;
  }

  private fill(target: Uint16Array, z: number): void {
    const depth = this.depths[z];
    if (depth === undefined) {
      throw new RangeError(`plane ${String(z)} asked for; allowed: 0 to ${String(this.depths.length - 1)}`);
    }
    const [a, b, c, d] = depth.samples.map((sample) => this.widenedPlane(sample)) as [
      Float32Array,
      Float32Array,
      Float32Array,
      Float32Array,
    ];
    const [wa, wb, wc, wd] = depth.weights;
    for (let i = 0; i < target.length; ++i) {
      const value = wa * (a[i] ?? 0) + wb * (b[i] ?? 0) + wc * (c[i] ?? 0) + wd * (d[i] ?? 0);
      // between far values it runs beyond them
      target[i] = Math.min(largest, Math.max(0, value + 0.5));
    }
    for (const sample of this.widened.keys()) {
      if (!depth.samples.includes(sample)) {
        this.widened.delete(sample);
      }
    }
  }

  private widenedPlane(sample: number): Float32Array {
    let plane = this.widened.get(sample);
    if (plane === undefined) {
      plane = this.widen(sample);
      this.widened.set(sample, plane);
    }
    return plane;
  }

  /** A coarse plane along x, then along y. */
  private widen(sample: number): Float32Array {
    const { columns, rows } = this;
    const { dimensions, values } = this.coarse;
    const [width, height] = dimensions;
    const lines = new Float32Array(columns.length * height);
    for (let y = 0; y < height; ++y) {
      const line = width * (y + height * sample);
      columns.forEach(({ samples: [a, b, c, d], weights: [wa, wb, wc, wd] }, x) => {
        const near = wb * (values[line + b] ?? 0) + wc * (values[line + c] ?? 0);
        lines[x + columns.length * y] = near + wa * (values[line + a] ?? 0) + wd * (values[line + d] ?? 0);
      });
    }
    const plane = new Float32Array(this.plane);
    rows.forEach(({ samples, weights: [wa, wb, wc, wd] }, y) => {
      const [a, b, c, d] = samples.map((row) => row * columns.length) as [number, number, number, number];
      const to = y * columns.length;
      for (let x = 0; x < columns.length; ++x) {
        plane[to + x] =
          wa * (lines[a + x] ?? 0) + wb * (lines[b + x] ?? 0) + wc * (lines[c + x] ?? 0) + wd * (lines[d + x] ?? 0);
      }
    });
    return plane;
  }
}

/** Beyond the first and the last sample values go on as there. */
function betweenSamples(place: number, count: number): Between {
  const first = Math.floor(place);
  const t = place - first;
  const held = (i: number): number => Math.min(count - 1, Math.max(0, i));
  return {
    samples: [held(first - 1), held(first), held(first + 1), held(first + 2)],
    weights: [
      t * (-0.5 + t * (1 - 0.5 * t)),
      1 + t * t * (-2.5 + 1.5 * t),
      t * (0.5 + t * (2 - 1.5 * t)),
      t * t * (-0.5 + 0.5 * t),
    ],
  };
}
