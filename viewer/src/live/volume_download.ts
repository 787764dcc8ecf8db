/**
 * The scan's voxels by HTTP, with progress.
 */
import type { Arrival, Planes } from "../core/scan/loading_scan";
import type { BrickRanges } from "../core/scan/bricks";
import { storedDimensions, type ScanFrame, type ScanVolume } from "../core/scan/scan_volume";
import type { LabelVolume } from "../core/scan/voxel_change";
import { apiAddress } from "./connection";
import { takeWorker } from "./early_workers";
import type { ShownParts, ValuesRequest, VolumeAnswer, VolumeRequest } from "./volume_messages";

export interface DownloadedScan {
  readonly volume: ScanVolume;
  readonly bricks: BrickRanges;
}

export interface DownloadOptions {
  /** Where from. */
  readonly path?: string;
  /** Told of the share that was received. */
  readonly progress?: (share: number) => void;
  /** Shows a scan of which some has arrived; what stands in for the rest is made from a coarse one. */
  readonly meanwhile?: Meanwhile;
}

export interface Meanwhile extends ShownParts {
  readonly coarse: ScanVolume;
  /** Told of the same volume each time, and never of all of it. */
  readonly show: (volume: ScanVolume, arrival: Arrival) => void;
}

/** Downloads every `step`-th value along each axis. */
export async function downloadVolume(
  frame: ScanFrame,
  step: number,
  options: DownloadOptions = {},
): Promise<DownloadedScan> {
  const { path = "/api/volume", progress, meanwhile } = options;
  const dimensions = storedDimensions(frame.dimensions, step);
  const plane = dimensions[0] * dimensions[1];
  const volume = { frame, step, dimensions, values: new Uint16Array(plane * dimensions[2]) };
  const url = apiAddress(`${path}?step=${String(step)}`);
  const request = {
    kind: "values",
    url,
    dimensions,
    step,
    meanwhile: meanwhile === undefined ? null : sent(meanwhile),
  } as const;
  const answer = await ask(request, {
    progress,
    planes: ({ first, values }) => {
      volume.values.set(values, first * plane);
    },
    arrival: (arrival) => meanwhile?.show(volume, arrival),
  });
  if (answer.kind !== "values") {
    throw new Error("the worker answered something else than values");
  }
  return { volume, bricks: answer.bricks };
}

/** Downloads the segments that are no threshold, as finely as the values. */
export async function downloadLabels({ frame, step }: ScanVolume): Promise<LabelVolume> {
  const dimensions = storedDimensions(frame.dimensions, step);
  const url = apiAddress(`/api/labels?step=${String(step)}`);
  const answer = await ask({ kind: "labels", url, dimensions }, {});
  if (answer.kind !== "labels") {
    throw new Error("the worker answered something else than labels");
  }
  return answer.labels;
}

/** What of a coarse scan a worker is sent. */
function sent({ coarse: { dimensions, values, step }, parts, soon }: Meanwhile): ValuesRequest["meanwhile"] {
  return { coarse: { dimensions, values, step }, parts, soon };
}

/** What a worker tells before it is done. */
interface Told {
  readonly progress?: ((share: number) => void) | undefined;
  readonly planes?: (planes: Planes) => void;
  readonly arrival?: (arrival: Arrival) => void;
}

/** Asks a worker of its own; fails where it fails. */
function ask(request: VolumeRequest, told: Told): Promise<VolumeAnswer> {
  const worker = takeWorker("volume");
  const answer = new Promise<VolumeAnswer>((resolve, reject) => {
    worker.onmessage = ({ data: message }: MessageEvent<VolumeAnswer>) => {
      switch (message.kind) {
        case "progress":
          told.progress?.(message.share);
          break;
        case "planes":
          told.planes?.(message.planes);
          break;
        case "arrival":
          told.arrival?.(message.arrival);
          break;
        case "failed":
          reject(new Error(message.text));
          break;
        default:
          resolve(message);
      }
    };
    worker.onerror = (event) => {
      reject(new Error(event.message));
    };
    worker.postMessage(request);
  });
  return answer.finally(() => {
    worker.terminate();
  });
}
