/**
 * The nodes or particles of a model of deformation, as the engine sends them.
 * Memory: places three uint16 each (0..65535 over the box [mm]), strains an int8 each.
 */
import type { MatterParts as Sent } from "../protocol";
import type { Vec3 } from "../geometry/vector";

export interface ModelParticles {
  /** Lower corner and edges of the box that they lie in, in the scene [mm]. */
  readonly origin: Vec3;
  readonly size: Vec3;
  /** Between neighbours at rest [mm]. */
  readonly apart: number;
  readonly count: number;
  readonly places: Uint16Array<ArrayBuffer>;
  /** -127 where pressed by half and more, 127 where pulled. */
  readonly strains: Int8Array<ArrayBuffer>;
}

/** Places of a part, as numbers and bytes. */
const numbers = 3;
const placeBytes = 2 * numbers;

/** Reads parts; null where their bytes do not fit together. */
export function decodeParticles({ origin, size, apart, places, strains }: Sent): ModelParticles | null {
  const count = strains.length;
  if (places.length !== count * placeBytes || !size.every((edge) => edge >= 0)) {
    return null;
  }
  return {
    origin,
    size,
    apart,
    count,
    places: new Uint16Array(places.slice().buffer),
    strains: new Int8Array(strains.slice().buffer),
  };
}
