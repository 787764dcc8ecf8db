/**
 * Runs in the browser: draws small scans with the real ray caster and hands the pixels back.
 */
import * as THREE from "three";
import { labelledBricks } from "../../src/core/scan/bricks";
import type { Vec3 } from "../../src/core/geometry/vector";
import { FieldTexture } from "../../src/gl/textures/field_texture";
import { byteTexture, labelColours } from "../../src/gl/textures/lookup_textures";
import { PictureTarget } from "../../src/gl/base/picture_target";
import { RayMarcher } from "../../src/gl/march/ray_marcher";
import { segment } from "../support/volumes";
import {
  bricksOf,
  edge,
  fieldOf,
  labelsInBox,
  labelsOfBall,
  appearanceOf,
  outlineOf,
  viewOf,
  voxels,
  type MarchResult,
  type MarchTest,
} from "./scenes_page";

export function march(test: MarchTest): MarchResult {
  const renderer = new THREE.WebGLRenderer({ canvas: document.createElement("canvas") });
  renderer.autoClear = false;
  const volume = fieldOf(test);
  const field = new FieldTexture(volume, test.format ?? "rg8");
  while (!field.uploadSlab(renderer));
  const marcher = new RayMarcher({ software: test.software ?? true, lightCells: 64 });
  marcher.setField(field, bricksOf(volume, test.skip ?? true));
  marcher.setAppearance(appearanceOf(test));
  marcher.setClip(test.clip ?? []);
  if (test.field === "label") {
    const [ambient, specular] = test.material ?? [1, 1];
    const colours = labelColours([{ ...segment, id: 7, colour: [1, 0, 0], range: null, ambient, specular }]);
    const ids = labelsInBox();
    const dimensions: Vec3 = [voxels, voxels, voxels];
    marcher.setLabelColours(colours);
    marcher.setLabels({ texture: byteTexture(ids, dimensions), bricks: labelledBricks(ids, dimensions) });
  }
  if (test.labels !== undefined) {
    const made_by = test.labels === "without values" ? null : ([0, 32767] as const);
    marcher.setLabelColours(labelColours([{ ...segment, colour: [0, 1, 0], range: null, made_by }]));
    const ids = labelsOfBall(volume, test.labels !== "as values");
    const { dimensions } = volume;
    marcher.setLabels({ texture: byteTexture(ids, dimensions), bricks: labelledBricks(ids, dimensions) });
  }

  const extent = outlineOf(test);
  const camera = viewOf(test, extent);
  marcher.setCamera(camera, extent, 1);
  const target = new PictureTarget(true);
  target.resize(edge, edge);
  target.useLevel(1);
  target.useRows(0, edge);
  marcher.draw(renderer, target, { stepsPerVoxel: test.stepsPerVoxel, jitter: false }, [0, 0, 0]);

  const halves = new Uint16Array(4 * edge * edge);
  renderer.readRenderTargetPixels(target.target, 0, 0, edge, edge, halves);
  renderer.dispose();
  renderer.forceContextLoss();
  return { pixels: Array.from(halves, (half) => THREE.DataUtils.fromHalfFloat(half)), camera, extent };
}
