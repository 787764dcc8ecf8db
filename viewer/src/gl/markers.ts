/**
 * Probe, device point, the line between them and the force arrow, in the scene [mm].
 *
 * Each is drawn twice: solid where nothing hides it, and as a faint ghost where bone or
 * tissue stands before it, so that the probe can always be found. Sizes follow the picture
 * [CSS pixels].
 */
import * as THREE from "three";
import { srgbFromHex } from "../core/colour";
import { addScaled, distance, length, normalize, subtract, type Vec3 } from "../core/vector";
import { ForceGauge } from "./force_gauge";
import { shaders } from "./shaders";

export interface MarkerState {
  readonly probe: Vec3;
  readonly device: Vec3;
  /** [N] */
  readonly force: Vec3;
  readonly contact: boolean;
  /** Size of a CSS pixel at the probe [mm]. */
  readonly pixel: number;
  /** Force that fills the ring [N]. */
  readonly fullForce: number;
}

/** Length of the arrow for one newton, and at most [pixels]. */
const arrowPerNewton = 40;
const longestArrow = 160;

/** How far a marker reaches beyond its points [pixels]. */
export const markerMargin = 20;
const ghostOpacity = 0.3;

const accent = srgbFromHex("#5cc8ff");
const pale = srgbFromHex("#dff3ff");
const amber = srgbFromHex("#ffb454");

/** One shape, its solid and its ghost. */
class Marker {
  readonly group = new THREE.Group();
  private readonly colour = new THREE.Vector3();

  constructor(geometry: THREE.BufferGeometry, opacity: number) {
    const solid = new THREE.Mesh(geometry, this.material(opacity, THREE.LessEqualDepth, opacity === 1));
    const ghost = new THREE.Mesh(geometry, this.material(opacity * ghostOpacity, THREE.GreaterDepth, false));
    // ghosts first: a solid marker then covers the ghost of another one
    ghost.renderOrder = 1;
    solid.renderOrder = 2;
    for (const mesh of [ghost, solid]) {
      mesh.frustumCulled = false;
      this.group.add(mesh);
    }
  }

  /** Shows the shape with its local y axis from `from` to `to`, `thick` mm wide. */
  span(from: Vec3, to: Vec3, thick: number): void {
    const long = distance(from, to);
    this.group.visible = long > 1e-6;
    this.group.position.set(...from);
    this.group.scale.set(thick, long, thick);
    this.group.quaternion.setFromUnitVectors(
      new THREE.Vector3(0, 1, 0),
      new THREE.Vector3(...normalize(subtract(to, from))),
    );
  }

  ball(centre: Vec3, radius: number): void {
    this.group.position.set(...centre);
    this.group.scale.setScalar(radius);
  }

  paint(colour: Vec3): void {
    this.colour.set(...colour);
  }

  dispose(): void {
    for (const child of this.group.children) {
      const mesh = child as THREE.Mesh<THREE.BufferGeometry, THREE.Material>;
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
  }

  private material(opacity: number, depthFunc: THREE.DepthModes, depthWrite: boolean): THREE.RawShaderMaterial {
    return new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: shaders.marker.vertex,
      fragmentShader: shaders.marker.fragment,
      uniforms: { colour: { value: this.colour }, opacity: { value: opacity } },
      transparent: true,
      premultipliedAlpha: true,
      depthFunc,
      depthWrite,
    });
  }
}

export class Markers {
  readonly scene = new THREE.Scene();
  private readonly probe = new Marker(new THREE.IcosahedronGeometry(1, 4), 1);
  private readonly device = new Marker(new THREE.IcosahedronGeometry(1, 3), 0.55);
  private readonly line = new Marker(cylinder(), 0.8);
  private readonly shaft = new Marker(cylinder(), 1);
  private readonly head = new Marker(cone(), 1);
  private readonly gauge = new ForceGauge(amber);

  private shown: MarkerState | null = null;
  private tip: Vec3 = [0, 0, 0];

  constructor() {
    for (const marker of this.all) {
      this.scene.add(marker.group);
    }
    this.scene.add(this.gauge.mesh);
    this.device.paint(accent);
    this.line.paint(accent);
    this.shaft.paint(amber);
    this.head.paint(amber);
  }

  /** Shows another state; false where nobody could see the difference. */
  update(state: MarkerState): boolean {
    if (this.shown !== null && looksSame(this.shown, state)) {
      return false;
    }
    this.shown = state;
    const { probe, device, force, pixel } = state;
    this.probe.paint(state.contact ? pale : accent);
    this.probe.ball(probe, 6.5 * pixel);
    this.device.ball(device, 4.5 * pixel);
    this.line.span(probe, device, pixel);
    this.device.group.visible = distance(probe, device) > 1.5 * pixel;

    const newtons = length(force);
    const share = Math.min(1, newtons / state.fullForce);
    const arrow = pixel * Math.min(longestArrow, arrowPerNewton * newtons);
    const tip = addScaled(probe, normalize(force), arrow + 8 * pixel);
    this.tip = tip;
    const neck = addScaled(tip, normalize(force), -12 * pixel);
    const shown = newtons > 1e-3;
    this.shaft.span(probe, neck, 1.9 * pixel);
    this.head.span(neck, tip, 5.5 * pixel);
    this.shaft.group.visible &&= shown && distance(probe, neck) > 6.5 * pixel;
    this.head.group.visible &&= shown;
    this.gauge.update(probe, shown ? share : 0, pixel);
    return true;
  }

  /** Points of the scene whose surroundings, `markerMargin` wide, hold everything that is drawn. */
  get outline(): readonly Vec3[] {
    return this.shown === null ? [] : [this.shown.probe, this.shown.device, this.tip];
  }

  dispose(): void {
    for (const marker of this.all) {
      marker.dispose();
    }
    this.gauge.dispose();
  }

  private get all(): readonly Marker[] {
    return [this.probe, this.device, this.line, this.shaft, this.head];
  }
}

/** Moves of less than a fifth of a pixel cannot be seen. */
function looksSame(a: MarkerState, b: MarkerState): boolean {
  const still = 0.2 * b.pixel;
  return (
    a.contact === b.contact &&
    a.pixel === b.pixel &&
    a.fullForce === b.fullForce &&
    distance(a.probe, b.probe) < still &&
    distance(a.device, b.device) < still &&
    distance(a.force, b.force) < 0.002 * b.fullForce
  );
}

/** Radius 1, from y = 0 to y = 1. */
function cylinder(): THREE.BufferGeometry {
  return new THREE.CylinderGeometry(1, 1, 1, 20).translate(0, 0.5, 0);
}

function cone(): THREE.BufferGeometry {
  return new THREE.ConeGeometry(1, 1, 28).translate(0, 0.5, 0);
}
