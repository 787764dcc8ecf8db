/**
 * The scan's voxels by HTTP, with progress.
 */
import type { BrickRanges } from "../core/bricks";
import { storedDimensions, type ScanFrame, type ScanVolume } from "../core/scan_volume";
import type { LabelVolume } from "../core/voxel_change";
import { apiAddress } from "./connection";
import { takeWorker } from "./early_workers";
import type { VolumeAnswer, VolumeRequest } from "./volume_messages";

export interface DownloadedScan {
  readonly volume: ScanVolume;
  readonly bricks: BrickRanges;
}

/** Downloads every `step`-th value along each axis; reports the share received. */
export async function downloadVolume(
  frame: ScanFrame,
  step: number,
  token: string,
  progress: (share: number) => void,
  path = "/api/volume",
): Promise<DownloadedScan> {
  const dimensions = storedDimensions(frame.dimensions, step);
  const url = apiAddress(`${path}?step=${String(step)}`, token);
  const answer = await ask({ kind: "values", url, dimensions }, progress);
  if (answer.kind !== "values") {
    throw new Error("the worker answered something else than values");
  }
  return { volume: { frame, step, dimensions, values: answer.values }, bricks: answer.bricks };
}

/** Downloads the segments that are no threshold, as finely as the values. */
export async function downloadLabels({ frame, step }: ScanVolume, token: string): Promise<LabelVolume> {
  const dimensions = storedDimensions(frame.dimensions, step);
  const url = apiAddress(`/api/labels?step=${String(step)}`, token);
  const answer = await ask({ kind: "labels", url, dimensions }, () => undefined);
  if (answer.kind !== "labels") {
    throw new Error("the worker answered something else than labels");
  }
  return answer.labels;
}

/** Asks a worker of its own; fails where it fails. */
function ask(request: VolumeRequest, progress: (share: number) => void): Promise<VolumeAnswer> {
  const worker = takeWorker("volume");
  const answer = new Promise<VolumeAnswer>((resolve, reject) => {
    worker.onmessage = (event: MessageEvent<VolumeAnswer>) => {
      const message = event.data;
      if (message.kind === "progress") {
        progress(message.share);
      } else if (message.kind === "failed") {
        reject(new Error(message.text));
      } else {
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
