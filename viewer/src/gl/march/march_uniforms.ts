/**
 * What the shaders of the ray caster are given: in sync with `shaders/march/march.frag` and what it is joined from.
 */
import * as THREE from "three";
import { transformPoint } from "../../core/geometry/affine";
import { brickEdge } from "../../core/scan/bricks";
import { eyeOf, sightOf, type Camera } from "../../core/geometry/camera";
import { mostPlanes } from "../../core/view/clip";
import { smallestSpacing, type ScanFrame, type ScanVolume } from "../../core/scan/scan_volume";
import { mostRanges } from "../../core/segments/shown_segments";
import { dot, scale, type Vec3 } from "../../core/geometry/vector";
import type { DisplacementTexture } from "../textures/displacement_texture";
import { keyLight } from "./key_light";

const vector = (v: Vec3 = [0, 0, 0]): THREE.Vector3 => new THREE.Vector3(...v);

// its type is what it returns: written out it would be the same list again
// eslint-disable-next-line @typescript-eslint/explicit-module-boundary-types
export function marchUniforms() {
  const many = (): THREE.Vector3[] => Array.from({ length: mostRanges }, () => vector());
  return {
    fieldTexture: { value: null as THREE.Texture | null },
    dimensions: { value: vector() },
    textureScale: { value: vector() },
    textureOffset: { value: vector() },
    sampleStep: { value: vector() },
    spacing: { value: vector() },
    slope: { value: 1 },
    rangeBounds: { value: Array.from({ length: mostRanges }, () => new THREE.Vector4()) },
    rangeColours: { value: many() },
    rangeMaterials: { value: many() },
    rangeCount: { value: 0 },
    bodies: { value: 0 },
    mostShells: { value: 0 },
    labelTexture: { value: null as THREE.Texture | null },
    labelColours: { value: null as THREE.Texture | null },
    keyDirection: { value: vector() },
    upDirection: { value: vector() },
    material: { value: new THREE.Vector4(1, 1, 1, 1) },
    pictureSize: { value: new THREE.Vector2() },
    shift: { value: vector() },
    eye: { value: vector() },
    forward: { value: vector() },
    across: { value: vector() },
    upward: { value: vector() },
    parallel: { value: 0 },
    nearFar: { value: new THREE.Vector2() },
    middleDepth: { value: 1 },
    clipPlanes: { value: Array.from({ length: mostPlanes }, () => new THREE.Vector4()) },
    clipCount: { value: 0 },
    stepLength: { value: 1 },
    haste: { value: 0 },
    jitter: { value: 1 },
    slab: { value: new THREE.Vector2() },
    transferTexture: { value: null as THREE.Texture | null },
    integralTexture: { value: null as THREE.Texture | null },
    transferEnds: { value: [new THREE.Vector4(), new THREE.Vector4()] as readonly [THREE.Vector4, THREE.Vector4] },
    transferScale: { value: new THREE.Vector2() },
    edge: { value: new THREE.Vector2() },
    density: { value: 1 },
    grey: { value: new THREE.Vector2() },
    tissueFrom: { value: 0 },
    isoColour: { value: vector() },
    brickTexture: { value: null as THREE.Texture | null },
    brickScale: { value: vector() },
    brickOffset: { value: vector() },
    surfaceColour: { value: null as THREE.Texture | null },
    surfaceDepth: { value: null as THREE.Texture | null },
    surfaceLead: { value: 0 },
    layerColour: { value: [] as THREE.Texture[] },
    layerDepth: { value: [] as THREE.Texture[] },
  };
}

export type MarchUniforms = ReturnType<typeof marchUniforms> & DisplacementTexture["uniforms"];
export type FieldUniform =
  | "fieldTexture"
  | "dimensions"
  | "textureScale"
  | "textureOffset"
  | "sampleStep"
  | "spacing"
  | "slope"
  | "labelTexture"
  | "material"
  | keyof DisplacementTexture["uniforms"];

/** Where the values of a scan stand in its grid, all or every `step`-th. */
export function standAt(u: ReturnType<typeof marchUniforms>, { frame, dimensions, step }: ScanVolume): void {
  u.dimensions.value.set(...frame.dimensions);
  u.spacing.value.set(...frame.spacing);
  u.sampleStep.value.setScalar(step);
  u.slope.value = frame.rescale.slope;
  u.surfaceLead.value = smallestSpacing(frame) * step;
  // texel centres stand at half numbers: see core/scan/scan_volume.ts
  const first = 0.5 - 0.5 / step;
  u.textureScale.value.set(...inverted(scale(dimensions, step)));
  u.textureOffset.value.set(...scale(inverted(dimensions), first));
  u.brickScale.value.setScalar(1 / (step * brickEdge));
  u.brickOffset.value.setScalar(first / brickEdge);
}

/** Where rays begin, where they go, and where the lamp stands, along the grid's axes. */
export function lookFrom(u: MarchUniforms, { axes, gridFromScene }: ScanFrame, camera: Camera, aspect: number): void {
  const along = (v: Vec3): Vec3 => [dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)];
  const half = Math.tan(camera.field / 2) * (camera.parallel === null ? 1 : camera.distance);
  u.eye.value.set(...transformPoint(gridFromScene, eyeOf(camera)));
  u.forward.value.set(...along(scale(sightOf(camera), -1)));
  u.across.value.set(...along(scale(camera.right, half * aspect)));
  u.upward.value.set(...along(scale(camera.up, half)));
  u.upDirection.value.set(...along(camera.up));
  u.keyDirection.value.set(...along(keyLight(camera)));
}

function inverted(v: Vec3): Vec3 {
  return [1 / v[0], 1 / v[1], 1 / v[2]];
}
