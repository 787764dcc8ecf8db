/** The recent way of the probe: a line of constant width on the screen that fades with age. */
import * as THREE from "three";
import { pieceNumbers, type PathTrail } from "../../core/touch/path_trail";
import type { Vec3 } from "../../core/geometry/vector";
import { GhostedQuads, strip } from "./ghosted_quads";
import { shaders } from "../shaders/shaders";

/** Half the width of the line, and how far it is drawn toward the eye [CSS pixels]. */
const halfWidth = 1.6;
const toward = 4;
const strength = { plain: 0.85, behind: 0.18 } as const;

/** Pieces drawn, at most. */
export const mostPieces = 512;

export class PathRibbon {
  private readonly pieces = new Float32Array(pieceNumbers * mostPieces);
  private readonly buffer = new THREE.InstancedInterleavedBuffer(this.pieces, pieceNumbers);
  private readonly uniforms = {
    pixel: { value: 1 },
    halfWidth: { value: halfWidth },
    toward: { value: toward },
    colour: { value: new THREE.Vector3() },
  };
  private readonly quads = new GhostedQuads(strip, shaders.path, this.uniforms, strength);
  /** Under the probe and its arrows. */
  readonly group = this.quads.group;

  constructor(colour: Vec3) {
    this.uniforms.colour.value.set(...colour);
    this.buffer.setUsage(THREE.DynamicDrawUsage);
    const { geometry } = this.quads;
    geometry.setAttribute("start", new THREE.InterleavedBufferAttribute(this.buffer, 3, 0));
    geometry.setAttribute("end", new THREE.InterleavedBufferAttribute(this.buffer, 3, 3));
    geometry.setAttribute("fresh", new THREE.InterleavedBufferAttribute(this.buffer, 2, 6));
  }

  /** @param pixel size of a CSS pixel at the probe [mm]. */
  update(trail: PathTrail, pixel: number): void {
    this.quads.geometry.instanceCount = trail.write(this.pieces);
    this.buffer.needsUpdate = true;
    this.uniforms.pixel.value = pixel;
  }

  dispose(): void {
    this.quads.dispose();
  }
}
