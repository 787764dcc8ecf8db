/**
 * The parts of the picture as what lies over them needs them: where points of the scene stand in
 * each, and where one goes that is dragged. Places are CSS pixels from a pane's upper left corner.
 */
import { alongView, project, rayThrough } from "../../core/geometry/camera";
import { placesInView, placesOnSlice } from "../../core/marks/mark_lines";
import type { Pane } from "../../core/view/pane";
import type { ShownEye } from "../../core/view/stereo";
import { placeOnSlice, pointOnSlice } from "../../core/slices/slice_plane";
import { add, addScaled } from "../../core/geometry/vector";
import type { ShownSlice } from "../../gl/picture/slices";
import type { Stage } from "./stage";

/** What an eye sees of the 3-D view: a dragged point goes to what is seen there, else stays as far away as it was. */
export function viewPane(stage: Stage, { camera, viewport, rect, stretch }: ShownEye): Pane {
  const { view } = stage.slices.panes;
  const [right, down] = stretch;
  return {
    name: "view",
    rect: { ...rect, x: view.x + rect.x, y: view.y + rect.y },
    placesOf: (points) =>
      placesInView(points, camera, viewport).map(
        (place) => place && { ...place, x: place.x / right, y: place.y / down },
      ),
    dragTo: (point, x, y) => {
      const from = project(camera, point, viewport);
      if (from === null) {
        return point;
      }
      const to = [x * right, y * down] as const;
      const ray = rayThrough(camera, ...to, viewport);
      return (
        stage.picker.along(ray)?.point ??
        add(point, alongView(camera, to[0] - from[0], to[1] - from[1], point, viewport))
      );
    },
  };
}

/** A slice: a dragged point stays as far before or behind it as it was. */
export function slicePane({ name, rect, plane }: ShownSlice): Pane {
  return {
    name,
    rect,
    placesOf: (points) => placesOnSlice(points, plane, rect),
    dragTo: (point, x, y) =>
      addScaled(pointOnSlice(plane, x, y, rect), plane.toward, placeOnSlice(plane, point, rect).before),
  };
}
