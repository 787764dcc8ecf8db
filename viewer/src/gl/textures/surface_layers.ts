/**
 * Where surfaces are drawn before the ray caster reads them: one picture of what is opaque,
 * and one for each layer of what is translucent, near to far; each with its depth, all as
 * fine as the level that is drawn. Keep the number in sync with `shaders/surfaces/surfaces.glsl`.
 */
import * as THREE from "three";
import { PictureTarget } from "../base/picture_target";

/** Translucent layers behind one another: what lies farther is left out. */
export const mostLayers = 4;

/** Textures that the ray caster reads in any variant, and those of each definition of its shaders. */
const readAlways = 6;
const readWith: Readonly<Record<string, number>> = { LABELS: 2, DISPLACED: 1, LIGHT_VOLUME: 1, SECOND: 3 };

/**
 * Layers for which there is room beside all else that the ray caster reads: a colour and a depth each.
 *
 * @param units textures that the GPU reads in one shader, at least 16.
 */
export function layersWithin(units: number, defines: Readonly<Record<string, string>>): number {
  const others = Object.keys(defines).reduce((sum, name) => sum + (readWith[name] ?? 0), readAlways);
  return Math.max(0, Math.min(mostLayers, Math.floor((units - others) / 2)));
}

export class SurfaceLayers {
  readonly opaque: PictureTarget;
  private readonly layers: readonly PictureTarget[];
  /** Layers in use. */
  translucent: readonly PictureTarget[] = [];

  constructor(halfFloat: boolean) {
    const target = (): PictureTarget => new PictureTarget(halfFloat, THREE.FloatType);
    this.opaque = target();
    this.layers = Array.from({ length: mostLayers }, target);
  }

  /**
   * Makes room for a level of the picture; layers cost memory only where they are used.
   *
   * @param translucent how many layers are drawn, at most `mostLayers`.
   */
  use(full: { readonly width: number; readonly height: number }, divisor: number, translucent: number): void {
    this.translucent = this.layers.slice(0, translucent);
    for (const layer of [this.opaque, ...this.translucent]) {
      if (layer.target.width !== full.width || layer.target.height !== full.height) {
        layer.resize(full.width, full.height);
      }
      layer.useLevel(divisor);
      layer.useRows(0, layer.height);
    }
  }

  dispose(): void {
    for (const layer of [this.opaque, ...this.layers]) {
      layer.dispose();
    }
  }
}
