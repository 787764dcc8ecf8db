/** What is asked of projections: the arc follows the beam, one edge stands for all three. */
import { expect, test } from "vitest";
import { askedOf, withBeam, withVoxel, type ReconstructionRequest } from "../../../src/core/library/reconstruction";

const request: ReconstructionRequest = {
  beam: "cone", pixel: [1, 2], arc: 360, first_angle: 0, zero: "back", offset: [0, 0],
  source_to_axis: 1000, source_to_detector: 1536,
  sinograms: false, intensities: null, size: null, voxel: null, water: 0.02, hann: 0,
};

test("parallel beams need half a circle, a cone a whole one", () => {
  const parallel = withBeam(request, "parallel");
  expect([parallel.beam, parallel.arc, parallel.source_to_axis]).toEqual(["parallel", 180, 1000]);
  expect(withBeam(parallel, "cone")).toEqual(request);
});

test("an edge is that of all three sides, and none that of pixels", () => {
  expect(withVoxel(request, 0.5).voxel).toEqual([0.5, 0.5, 0.5]);
  expect(withVoxel(withVoxel(request, 0.5), null)).toEqual(request);
});

test("a geometry file takes the place of all that it states", () => {
  expect(askedOf(3, request, null)).toEqual({ find: 3, request, geometry: null });
  const asked = askedOf(3, { ...request, hann: 0.6 }, { name: "geometry.xml", upload: 7 });
  expect(asked.geometry).toBe(7);
  // the engine refuses the rest beside the file
  expect(asked.request).toEqual({
    beam: "cone", pixel: [1, 2], sinograms: false, intensities: null, size: null, voxel: null, water: 0.02, hann: 0.6,
  });
});
