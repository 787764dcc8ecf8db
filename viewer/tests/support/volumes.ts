/** Small scans, segments and states for tests. */
import { brickRanges, type BrickRanges } from "../../src/core/scan/bricks";
import { frameOf, storedDimensions, type ScanVolume } from "../../src/core/scan/scan_volume";
import type { Safety, Scan, Segment, Settings } from "../../src/core/protocol";
import type { Vec3 } from "../../src/core/geometry/vector";

export function scanOf(dimensions: Vec3, spacing: Vec3, origin: Vec3 = [0, 0, 0]): Scan {
  const [x, y, z] = spacing;
  return {
    name: "test",
    title: "test",
    identity: "0123",
    patient: "",
    modality: "CT",
    unit: "HU",
    dimensions,
    spacing,
    patient_from_grid: [x, 0, 0, origin[0], 0, y, 0, origin[1], 0, 0, z, origin[2], 0, 0, 0, 1],
    slope: 1,
    intercept: 0,
    range: [-1024, 3071],
    histogram: { low: -1024, high: 3071, counts: [1] },
    presets: [],
    soft_tissue: 40,
    bone: 250,
    volume: null,
    rereadable: true,
    no_dicom: null,
    orientation_known: true,
    warnings: [],
    notes: [],
  };
}

/** A scan whose value at each voxel's centre (grid coordinates) is given. */
export function volumeOf(
  scan: Scan,
  valueAt: (centre: Vec3) => number,
  step = 1,
): ScanVolume & { readonly bricks: BrickRanges } {
  const dimensions = storedDimensions(scan.dimensions, step);
  const values = new Uint16Array(dimensions[0] * dimensions[1] * dimensions[2]);
  let i = 0;
  for (let z = 0; z < dimensions[2]; ++z) {
    for (let y = 0; y < dimensions[1]; ++y) {
      for (let x = 0; x < dimensions[0]; ++x) {
        values[i++] = 32768 + Math.round(valueAt([x * step + 0.5, y * step + 0.5, z * step + 0.5]));
      }
    }
  }
  return { frame: frameOf(scan), step, dimensions, values, bricks: brickRanges({ dimensions, values }) };
}

/** A threshold segment, as every test may change it. */
export const segment: Segment = {
  id: 1,
  name: "bone",
  colour: [1, 1, 1],
  visible: true,
  touched_while_hidden: false,
  touchable: true,
  felt: true,
  locked: false,
  range: [0, 3000],
  voxels: 0,
  volume_ml: 0,
  pending: false,
  feel: { stiffness: null, friction_static: null, friction_kinetic: null },
  material: null,
  regions: [],
  pose: null,
  bounds: null,
  grid: null,
  steps: null,
  shown_as: "volume",
  surface_from: "intensities",
  made_by: null,
  opacity: 1,
  smoothing: 3,
  wireframe: false,
  ambient: 1,
  specular: 1,
};

export const settings: Settings = {
  model: "exact",
  stiffness: 1,
  damping: 0.001,
  friction_static: 0,
  friction_kinetic: 0,
  smoothing: "intensities",
  probe_radius: 0,
  gain: 1,
  force_limit: 4,
};

/** Nothing counted, nothing held back. */
export const safety: Safety = {
  clamped: 0,
  slewed: 0,
  not_finite: 0,
  ramped: 0,
  waited: 0,
  eased: 0,
  damped: 0,
  watchdog: 0,
  violations: 0,
  force: "on",
  off: null,
};
