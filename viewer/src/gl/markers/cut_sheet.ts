/** The surface that a cut would go along, translucent, and fainter where something stands before it. Scene [mm]. */
import * as THREE from "three";
import { srgbFromHex } from "../../core/base/colour";
import { cross, normalize, subtract, type Vec3 } from "../../core/geometry/vector";
import type { CutSheet } from "../../core/segments/cut_sheet";
import { Marker } from "./marker";

const opacity = 0.4;
const ghost = 0.45;

export class CutSheetShape {
  readonly scene = new THREE.Scene();
  private readonly geometry = new THREE.BufferGeometry();
  private readonly marker = new Marker(this.geometry, opacity, ghost, THREE.DoubleSide);

  constructor() {
    this.scene.add(this.marker.group);
    // as the line over the picture is: --warning in theme.css
    this.marker.paint(srgbFromHex("#ffb454"));
    this.show(null);
  }

  /** Shows a sheet; none with null. */
  show(sheet: CutSheet | null): void {
    this.scene.visible = sheet !== null;
    if (sheet === null) {
      return;
    }
    // each piece with corners of its own, so that it is lit as the flat piece that it is
    const places: number[] = [];
    const normals: number[] = [];
    sheet.slice(1).forEach(([near, far], i) => {
      const [nearBefore, farBefore] = sheet[i] ?? [near, far];
      const normal = normalize(cross(subtract(near, nearBefore), subtract(farBefore, nearBefore)));
      for (const corner of [nearBefore, farBefore, near, near, farBefore, far]) {
        places.push(...corner);
        normals.push(...normal);
      }
    });
    const { geometry } = this;
    // gives the buffers of what was shown back
    geometry.dispose();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
    geometry.setAttribute("normal", new THREE.Float32BufferAttribute(normals, 3));
  }

  draw(renderer: THREE.WebGLRenderer, camera: THREE.Camera): void {
    if (this.scene.visible) {
      renderer.render(this.scene, camera);
    }
  }

  dispose(): void {
    this.marker.dispose();
  }
}

/** Points around a sheet. */
export function outlineOf(sheet: CutSheet | null): readonly Vec3[] {
  return (sheet ?? []).flat();
}
