/**
 * Projections that a scan can be reconstructed from: what the engine tells of them and is asked.
 */
import type { Vec3 } from "../geometry/vector";

export type Beam = "parallel" | "cone";

/** Side of the patient at which the source is at angle 0. */
export type Zero = "back" | "front";

/** How projections were taken, and which scan is wanted of them; lengths in mm, angles in degrees. */
export interface ReconstructionRequest {
  readonly beam: Beam;
  /** Of the detector along columns and rows. */
  readonly pixel: readonly [number, number];
  readonly arc: number;
  readonly first_angle: number;
  /** Of the detector's middle from the central ray. */
  readonly offset: readonly [number, number];
  readonly source_to_axis: number;
  readonly source_to_detector: number;
  readonly zero: Zero;
  /** Whether each image is one row of the detector at all angles. */
  readonly sinograms: boolean;
  /** What the detector counts without a patient; null where values are line integrals. */
  readonly intensities: number | null;
  /** Voxels; null for all that is seen. */
  readonly size: Vec3 | null;
  /** Their edges; null for those of pixels. */
  readonly voxel: Vec3 | null;
  /** Attenuation [1/mm]. */
  readonly water: number;
  /** Where a window smooths to 0, as a share of the highest frequency; 0 for none. */
  readonly hann: number;
}

/** A request where a geometry file states angles, distances and places. */
export type RequestWithFile = Omit<
  ReconstructionRequest,
  "arc" | "first_angle" | "offset" | "source_to_axis" | "source_to_detector" | "zero"
>;

/** A file that states the geometry, as it was brought to the engine. */
export interface GeometryFile {
  readonly name: string;
  readonly upload: number;
}

/** What is asked of the engine. */
export interface AskedReconstruction {
  readonly find: number;
  readonly request: ReconstructionRequest | RequestWithFile;
  /** Upload of a geometry file; null for what the form says. */
  readonly geometry: number | null;
}

/** What was found where scans were looked for. */
export interface Projections {
  readonly find: number;
  readonly name: string;
  /** Images, rows, columns. */
  readonly shape: Vec3;
  readonly suggested: ReconstructionRequest;
  /** How the library is installed that makes scans of them; null where it is. */
  readonly missing: string | null;
}

/** The scan that would come. */
export interface ReconstructionGrid {
  readonly size: Vec3;
  /** [mm] */
  readonly voxel: Vec3;
}

/** A request for what was found; a geometry file takes the place of what the form says of the same. */
export function askedOf(
  find: number,
  request: ReconstructionRequest,
  file: GeometryFile | null,
): AskedReconstruction {
  if (file === null) {
    return { find, request, geometry: null };
  }
  const { beam, pixel, sinograms, intensities, size, voxel, water, hann } = request;
  return {
    find,
    request: { beam, pixel, sinograms, intensities, size, voxel, water, hann },
    geometry: file.upload,
  };
}

/** The usual arc of a beam: parallel ones see the same from behind. */
export function withBeam(request: ReconstructionRequest, beam: Beam): ReconstructionRequest {
  return { ...request, beam, arc: beam === "parallel" ? 180 : 360 };
}

/** One edge for all three, or those of pixels where it is none. */
export function withVoxel(request: ReconstructionRequest, edge: number | null): ReconstructionRequest {
  return { ...request, voxel: edge === null ? null : [edge, edge, edge] };
}
