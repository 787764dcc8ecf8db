/**
 * The line that a needle goes in along, from where its tip was at which depths: in tissue the tip stays on a straight
 * line from the entry. Frame: scene [mm].
 *
 * Once the depths differ enough it is the least-squares line of place over depth; before that it leads from where the
 * needle was seen last before it went in.
 */
import type { State } from "../protocol";
import { addScaled, distance, length, normalize, scale, subtract, type Vec3 } from "../geometry/vector";

export interface NeedleLine {
  /** Where the needle went in. */
  readonly entry: Vec3;
  /** Inward, of length 1. */
  readonly direction: Vec3;
}

/** Depths that are nearer are one place [mm]. */
const apart = 0.2;
/** A line is fitted to depths that differ by so much [mm]. */
const enough = 3;
/** A way has a direction from this length on [mm]. */
const least = 0.5;

export class NeedleTrack {
  /** Null outside, and as long as nothing tells. */
  line: NeedleLine | null = null;

  /** Where the tip was last before it went in. */
  private outside: Vec3 | null = null;
  private depths: number[] = [];
  private places: Vec3[] = [];

  /** Takes where the needle is now. */
  take({ needle, proxy, tool }: Pick<State, "needle" | "proxy" | "tool">): void {
    if (!needle.inside) {
      this.line = null;
      this.depths = [];
      this.places = [];
      this.outside = tool.kind === "needle" ? proxy : null;
      return;
    }
    if (this.depths.every((depth) => Math.abs(depth - needle.depth) > apart)) {
      this.depths.push(needle.depth);
      this.places.push(proxy);
    }
    this.line = this.fitted() ?? this.fromOutside(proxy, needle.depth) ?? this.line;
  }

  private fromOutside(tip: Vec3, depth: number): NeedleLine | null {
    const { outside } = this;
    if (outside === null || distance(tip, outside) < least) {
      return null;
    }
    const direction = normalize(subtract(tip, outside));
    return { entry: addScaled(tip, direction, -depth), direction };
  }

  private fitted(): NeedleLine | null {
    const { depths, places } = this;
    if (depths.length < 2 || Math.max(...depths) - Math.min(...depths) < enough) {
      return null;
    }
    const mean = (numbers: readonly number[]): number => numbers.reduce((a, b) => a + b, 0) / numbers.length;
    const middle = mean(depths);
    const spread = mean(depths.map((depth) => (depth - middle) ** 2));
    const along = (axis: 0 | 1 | 2): readonly [number, number] => [
      mean(places.map((place, i) => (place[axis] * ((depths[i] ?? 0) - middle)) / spread)),
      mean(places.map((place) => place[axis])),
    ];
    const [x, y, z] = [along(0), along(1), along(2)];
    const slope: Vec3 = [x[0], y[0], z[0]];
    const centre: Vec3 = [x[1], y[1], z[1]];
    const size = length(slope);
    return size > 0 ? { entry: addScaled(centre, slope, -middle), direction: scale(slope, 1 / size) } : null;
  }
}
