/**
 * Mixes what two eyes see into one picture for glasses that are red at the left and cyan at the right.
 */
import * as THREE from "three";
import { FullscreenPass } from "../base/fullscreen_pass";
import { shaders } from "../shaders/shaders";

export class Anaglyph {
  /** What is mixed: as it would stand on the screen, with its depth. */
  readonly eyes = [target(), target()] as const;
  private readonly uniforms = {
    leftEye: { value: this.eyes[0].texture },
    rightEye: { value: this.eyes[1].texture },
    corner: { value: new THREE.Vector2() },
  };
  private readonly pass = new FullscreenPass(shaders.anaglyph, this.uniforms);

  /** Makes room for pictures of this size [device pixels]. */
  resize(width: number, height: number): void {
    for (const eye of this.eyes) {
      eye.setSize(width, height);
    }
  }

  /** Gives the room back. */
  forget(): void {
    for (const eye of this.eyes) {
      eye.dispose();
    }
  }

  /** @param corner lower left of the pane on the screen, or in what it is drawn into instead [device pixels]. */
  draw(
    renderer: THREE.WebGLRenderer,
    corner: readonly [number, number],
    into: THREE.WebGLRenderTarget | null = null,
  ): void {
    this.uniforms.corner.value.set(...corner);
    this.pass.draw(renderer, into);
  }

  dispose(): void {
    this.forget();
    this.pass.dispose();
  }
}

function target(): THREE.WebGLRenderTarget {
  return new THREE.WebGLRenderTarget(1, 1, { generateMipmaps: false });
}
