/**
 * `window.palpate.bench`: what `palpate bench render` measures and hands to another renderer.
 */
import { transformPoint } from "../../../core/geometry/affine";
import { eyeOf, orbit } from "../../../core/geometry/camera";
import { smallestSpacing } from "../../../core/scan/scan_volume";
import { physical } from "../../../core/scan/stored_values";
import type { ControlPoint } from "../../../core/appearance/transfer_function";
import type { Vec3 } from "../../../core/geometry/vector";
import type { TimedPicture, TimedWish } from "../../../gl/picture/timed_picture";
import type { Stage } from "../stage";

/** All that another renderer needs to draw the same. Lengths in mm, in the scene. */
export interface BenchScene {
  /** Values as they are meant, x fastest; of the whole scan. */
  readonly values: Int16Array;
  readonly dimensions: Vec3;
  readonly spacing: Vec3;
  /** The middle of the first voxel, and the directions of the grid's axes. */
  readonly origin: Vec3;
  readonly axes: readonly [Vec3, Vec3, Vec3];
  readonly smallestSpacing: number;
  readonly points: readonly ControlPoint[];
  readonly eye: Vec3;
  readonly target: Vec3;
  readonly up: Vec3;
  /** Vertical angle of view [rad]. */
  readonly field: number;
}

export interface BenchHooks {
  /** When the picture of all of the scan stood on the screen [ms since the page was opened], or null. */
  readonly wholePicture: number | null;
  /** Pictures and strips that the GPU has drawn to the end. */
  readonly pieces: number;
  /**
   * Numbers of the engine's pictures: of the last request, of the one on display, turned or not, and how many turned
   * ones were drawn; null where the browser draws.
   */
  readonly numbers: { readonly requested: number; readonly shown: number; readonly turns: number } | null;
  /** Turns the view about the body's long axis [rad]. */
  readonly turn: (angle: number) => void;
  /** Draws the view as it is now, away from the screen; null before there is one. */
  readonly draw: (wish: TimedWish) => TimedPicture | null;
  /** What is drawn; null before there is a scan, or where the page holds only a part of its values. */
  readonly scene: () => BenchScene | null;
}

export function benchHooks(stage: Stage): BenchHooks {
  return {
    get wholePicture() {
      return stage.loader.wholePicture;
    },
    get pieces() {
      return stage.picture.drawn?.pieces ?? 0;
    },
    get numbers() {
      return stage.picture.drawn?.engineNumbers ?? null;
    },
    turn: (angle) => {
      stage.view.camera = stage.view.camera && orbit(stage.view.camera, angle, 0);
    },
    draw: (wish) => stage.picture.drawn?.drawTimed(wish) ?? null,
    scene: () => sceneOf(stage),
  };
}

function sceneOf({ view: { camera }, loader, scene }: Stage): BenchScene | null {
  const held = loader.held?.volume;
  if (camera === null || held === undefined || scene.appearance === null || held.step !== 1) {
    return null;
  }
  const { frame, values } = held;
  const { axes, dimensions, rescale, sceneFromGrid, spacing } = frame;
  return {
    values: Int16Array.from(values, (stored) => Math.round(physical(stored, rescale))),
    dimensions,
    spacing,
    origin: transformPoint(sceneFromGrid, [0.5, 0.5, 0.5]),
    axes,
    smallestSpacing: smallestSpacing(frame),
    points: scene.appearance.transferFunction.points,
    eye: eyeOf(camera),
    target: camera.target,
    up: camera.up,
    field: camera.field,
  };
}
