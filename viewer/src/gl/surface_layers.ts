/**
 * Where surfaces are drawn before the ray caster reads them: one picture of what is opaque,
 * and one for each layer of what is translucent, near to far; each with its depth, all as
 * fine as the level that is drawn. Keep the number in sync with `shaders/surfaces.glsl`.
 */
import * as THREE from "three";
import { PictureTarget } from "./picture_target";

/** Translucent layers behind one another: what lies farther is left out. */
export const mostLayers = 4;

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
