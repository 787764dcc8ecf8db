/**
 * What stands at a place of the picture: the segment or tissue that a ray meets first, and what a voxel is.
 */
import { transformPoint } from "../../core/geometry/affine";
import { pixelSizeAt, project, rayThrough, type Ray } from "../../core/geometry/camera";
import { valueInVoxel } from "../../core/scan/field";
import { unmoved } from "../../core/geometry/object_pose";
import { surfaceCrossings } from "../../core/picking/pick_patches";
import { pickScans, type PickedOfTwo } from "../../core/picking/pick_scans";
import type { Segment } from "../../core/protocol";
import { drawnAsSurface, drawnFromVoxels } from "../../core/segments/shown_segments";
import { dot, subtract, type Vec3 } from "../../core/geometry/vector";
import type { ClipControl } from "../features/view/clip_control.svelte";
import type { ScanLoader } from "../features/scan/scan_loader.svelte";
import type { SecondControl } from "../features/second/second_control.svelte";
import type { Session } from "../state/session.svelte";
import type { ShownEdits } from "../features/scan/shown_edits.svelte";
import type { StereoControl } from "../features/view/stereo_control.svelte";
import type { ViewControl } from "../features/view/view_control.svelte";
import type { DrawnScene } from "./drawn_scene.svelte";

/** What is drawn. */
interface Drawn {
  readonly loader: ScanLoader;
  readonly scene: DrawnScene;
  readonly edits: ShownEdits;
  readonly clips: ClipControl;
  readonly second: SecondControl;
  readonly stereo: StereoControl;
  readonly view: ViewControl;
}

/** What lies in a surface is not hidden by it [CSS pixels]; as far as marks are drawn before it. */
const lift = 6;

export class Picker {
  constructor(
    private readonly drawn: Drawn,
    private readonly session: Session,
  ) {}

  /** What stands at a place of the 3-D view's pane [CSS pixels]: seen by the eye that is pointed with. */
  at(x: number, y: number): PickedOfTwo | null {
    const eye = this.drawn.stereo.at(x, y);
    return eye && this.along(rayThrough(eye.camera, ...eye.place, eye.viewport));
  }

  /** What a ray of the scene meets first. */
  along(ray: Ray): PickedOfTwo | null {
    const { loader, scene, edits, clips, second } = this.drawn;
    const { appearance: drawn, segments } = scene;
    const volume = loader.held?.volume;
    if (volume === undefined || drawn === null) {
      return null;
    }
    const poses = this.session.latest?.poses ?? [];
    const surfaces = segments.filter(drawnAsSurface).map(({ id, pose, opacity }) => ({
      id,
      // where it stands by now; its list has where it was asked to go
      pose: poses.find((moved) => moved.id === id)?.pose ?? pose ?? unmoved,
      opacity,
      patches: edits.patches(id),
    }));
    const labelAt = (grid: Vec3): { readonly id: number; readonly visible: boolean } | null => {
      const label = edits.labelAt(grid, volume.step);
      const segment = segments.find(({ id, range, visible }) => id === label && range === null && visible);
      const solid = segment !== undefined && (scene.inside[label] ?? "solid") === "solid";
      return segment === undefined || (!solid && drawnFromVoxels(segment))
        ? null
        : { id: label, visible: drawnFromVoxels(segment) };
    };
    // an edited threshold is where its labels are
    const ranges = drawn.ranges.filter((range) => range.label === 0 && range.tinted !== true);
    const also = { crossings: surfaceCrossings(surfaces, ray), labelAt, clip: clips.cutting };
    return pickScans(volume, { ...drawn, ranges }, ray, also, second.shown);
  }

  /** Whether something stands before a point of the scene, seen from between the eyes. */
  hides(point: Vec3): boolean {
    const { camera, viewport } = this.drawn.view;
    const place = camera && project(camera, point, viewport);
    if (camera === null || place === null) {
      return false;
    }
    const ray = rayThrough(camera, ...place, viewport);
    const found = this.along(ray);
    return (
      found !== null && dot(subtract(point, found.point), ray.direction) > lift * pixelSizeAt(camera, point, viewport)
    );
  }

  /** Value of the scan at a point of the scene; null outside of it and before it is here. */
  valueAt(point: Vec3): number | null {
    const volume = this.drawn.loader.held?.volume;
    return volume === undefined ? null : valueInVoxel(volume, transformPoint(volume.frame.gridFromScene, point));
  }

  /** The segment that a voxel of the scan belongs to; one that is visible before others. */
  segmentAt(point: Vec3): Segment | null {
    const { loader, scene, edits } = this.drawn;
    const volume = loader.held?.volume;
    if (volume === undefined) {
      return null;
    }
    const label = edits.labelAt(transformPoint(volume.frame.gridFromScene, point), volume.step);
    const value = this.valueAt(point) ?? NaN;
    const holding = scene.segments.filter(
      ({ id, range, pose, grid }) =>
        pose === null && grid === null && (range === null ? id === label : range[0] <= value && value <= range[1]),
    );
    return holding.find(({ visible }) => visible) ?? holding[0] ?? null;
  }
}
