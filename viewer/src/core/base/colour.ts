/**
 * Colours between what is stored (sRGB) and what light is computed in (linear RGB).
 * Source: IEC 61966-2-1 (sRGB).
 */
import type { Vec3 } from "../geometry/vector";

export function linearFromSrgb(colour: Vec3): Vec3 {
  const convert = (c: number): number => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  return [convert(colour[0]), convert(colour[1]), convert(colour[2])];
}

export function srgbFromLinear(colour: Vec3): Vec3 {
  const convert = (c: number): number => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
  return [convert(colour[0]), convert(colour[1]), convert(colour[2])];
}

/** sRGB 0..1 from "#rrggbb". */
export function srgbFromHex(hex: string): Vec3 {
  if (!/^#[0-9a-f]{6}$/i.test(hex)) {
    throw new RangeError(`a colour is written #rrggbb, got ${JSON.stringify(hex)}`);
  }
  const part = (start: number): number => Number.parseInt(hex.slice(start, start + 2), 16) / 255;
  return [part(1), part(3), part(5)];
}

export function hexFromSrgb(colour: Vec3): string {
  const part = (c: number): string =>
    Math.round(255 * Math.min(1, Math.max(0, c)))
      .toString(16)
      .padStart(2, "0");
  return `#${part(colour[0])}${part(colour[1])}${part(colour[2])}`;
}

export function linearFromHex(hex: string): Vec3 {
  return linearFromSrgb(srgbFromHex(hex));
}

/** sRGB of a hue [degrees], as light as is read on black and on grey. */
export function srgbFromHue(hue: number): Vec3 {
  // CSS Color 4, hsl(hue 100% 58%)
  const part = (n: number): number => {
    const k = (((n + hue / 30) % 12) + 12) % 12;
    return 0.58 - 0.42 * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  };
  return [part(0), part(8), part(4)];
}
