/** Marks in the 3-D view: lines of constant width on the screen, and rings at their points. */
import * as THREE from "three";
import { srgbFromHex } from "../../core/base/colour";
import type { Vec3 } from "../../core/geometry/vector";
import { GhostedQuads, strip } from "./ghosted_quads";
import { shaders } from "../shaders/shaders";

/**
 * Half the width of a line, with its halo, radius of a ring, half the square it is drawn in, and how far toward the eye
 * [CSS pixels].
 */
const halfLine = 0.9;
const reach = [2.2, 6.5] as const;
const ring = 4;
const toward = 6;
const strength = { plain: 1, behind: 0.3 } as const;

/** Numbers of a piece: from (x, y, z), to (x, y, z); both are one place for a point. */
const pieceNumbers = 6;

/** A line that ends at the very point where it begins goes around something: it has no points to take hold of. */
function isOutline(points: readonly Vec3[]): boolean {
  return points.length > 2 && points[0] === points.at(-1);
}

export class MarkStrokes {
  readonly scene = new THREE.Scene();
  private readonly uniforms = {
    height: { value: 1 },
    reach: { value: new THREE.Vector2(...reach) },
    toward: { value: toward },
    // as in theme.css
    colour: { value: new THREE.Vector3(...srgbFromHex("#ff9ad5")) },
    halfLine: { value: halfLine },
    ring: { value: ring },
  };
  private readonly quads = new GhostedQuads(strip, shaders.mark, this.uniforms, strength);

  constructor() {
    this.scene.add(this.quads.group);
    this.show([]);
  }

  /** @param lines points of each mark, in their order; scene [mm]. */
  show(lines: readonly (readonly Vec3[])[]): void {
    const pieces = lines.flatMap((points) => [
      ...points.slice(1).map((point, i) => [...(points[i] ?? point), ...point]),
      ...(isOutline(points) ? [] : points.map((point) => [...point, ...point])),
    ]);
    const { geometry } = this.quads;
    // gives the buffers of what was shown back
    geometry.dispose();
    const buffer = new THREE.InstancedInterleavedBuffer(new Float32Array(pieces.flat()), pieceNumbers);
    geometry.setAttribute("start", new THREE.InterleavedBufferAttribute(buffer, 3, 0));
    geometry.setAttribute("end", new THREE.InterleavedBufferAttribute(buffer, 3, 3));
    geometry.instanceCount = pieces.length;
    this.scene.visible = pieces.length > 0;
  }

  /** @param height of what is seen [CSS pixels]. */
  draw(renderer: THREE.WebGLRenderer, camera: THREE.Camera, height: number): void {
    if (this.scene.visible) {
      this.uniforms.height.value = height;
      renderer.render(this.scene, camera);
    }
  }

  dispose(): void {
    this.quads.dispose();
  }
}
