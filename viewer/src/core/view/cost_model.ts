/**
 * What pictures cost, learned from those that were drawn: a wait for each, a part per sample and a part per triangle.
 *
 * A Kalman filter whose state are the three costs, which wander, and whose measurements are times: what was expected
 * wrongly is laid to each cost by how little is known of it, and pictures of several sizes soon tell them apart.
 * Source: Kalman, "A new approach to linear filtering and prediction problems" (1960).
 */

import { add, addScaled, dot, scale, type Vec3 } from "../geometry/vector";

/** What is counted of a picture; of costs, the time of each [ms]. */
export interface Workload {
  /** How often the renderer was waited for. */
  readonly waits: number;
  /** Pixels times steps per voxel edge. */
  readonly samples: number;
  readonly triangles: number;
}

/** Of waits, samples and triangles. */
type Triple = Vec3;

/** Times of like pictures differ by this share of what is expected (standard deviation). */
const noise = 0.1;
/**
 * A cost wanders from picture to picture by this share of it, or of a tenth of its first guess (standard deviation).
 */
const wander = 0.05;

export class CostModel {
  /** [ms each]. */
  private costs: Triple;
  private readonly least: Triple;
  /** Covariance of the costs, a row each. */
  private covariance: readonly [Triple, Triple, Triple];

  /** @param guess of what is not known yet, off by as much as it is [ms each]. */
  constructor(guess: Workload) {
    const [a, b, c] = (this.costs = listed(guess));
    this.least = scale(this.costs, 0.1);
    this.covariance = [[a * a, 0, 0], [0, b * b, 0], [0, 0, c * c]];
  }

  /** Expected time [ms]. */
  expected(work: Partial<Workload>): number {
    return dot(this.costs, listed(work));
  }

  /** Learns that work took `milliseconds`. */
  learn(work: Workload, milliseconds: number): void {
    const counted = listed(work);
    const expected = dot(this.costs, counted);
    const [first, second, third] = this.covariance;
    const shared: Triple = [dot(first, counted), dot(second, counted), dot(third, counted)];
    const gain = scale(shared, 1 / (dot(shared, counted) + (noise * expected) ** 2));
    const [a, b, c] = (this.costs = notBelowZero(addScaled(this.costs, gain, milliseconds - expected)));
    const [x, y, z] = this.least;
    const wandered = (cost: number, least: number): number => (wander * Math.max(cost, least)) ** 2;
    this.covariance = [
      addScaled(add(first, [wandered(a, x), 0, 0]), shared, -gain[0]),
      addScaled(add(second, [0, wandered(b, y), 0]), shared, -gain[1]),
      addScaled(add(third, [0, 0, wandered(c, z)]), shared, -gain[2]),
    ];
  }
}

function listed({ waits = 0, samples = 0, triangles = 0 }: Partial<Workload>): Triple {
  return [waits, samples, triangles];
}

function notBelowZero([a, b, c]: Triple): Triple {
  return [Math.max(0, a), Math.max(0, b), Math.max(0, c)];
}
