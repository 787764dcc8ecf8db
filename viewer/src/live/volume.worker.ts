/**
 * Downloads voxels and prepares them for the picture, off the page's thread.
 */
import { LoadingScan, StandIn, type Planes } from "../core/scan/loading_scan";
import { labelledBricks } from "../core/scan/bricks";
import type { LabelsRequest, ValuesRequest, VolumeAnswer, VolumeRequest } from "./volume_messages";

/** Between two looks at how quickly a scan arrives [ms]. */
const lookMilliseconds = 500;

function tell(answer: VolumeAnswer, transfer: Transferable[] = []): void {
  postMessage(answer, { transfer });
}

function tellPlanes(planes: Planes): void {
  tell({ kind: "planes", planes }, [planes.values.buffer]);
}

/** Receives exactly `size` bytes, with progress; hands them on as they come. */
async function download(url: string, size: number, take: (bytes: Uint8Array) => void): Promise<void> {
  const response = await fetch(url, { cache: "no-store" });
  if (!response.ok || response.body === null) {
    throw new Error(`the engine answered ${String(response.status)} ${response.statusText}`);
  }
  let received = 0;
  for (const reader = response.body.getReader(); ; ) {
    const { done, value } = await reader.read();
    if (done) {
      break;
    }
    if (received + value.length > size) {
      throw new Error(`the engine sent more than the ${String(size)} bytes of this scan`);
    }
    take(value);
    received += value.length;
    tell({ kind: "progress", share: received / size });
  }
  if (received < size) {
    throw new Error(`the engine sent ${String(received)} of ${String(size)} bytes`);
  }
}

async function bringLabels({ url, dimensions }: LabelsRequest): Promise<void> {
  const ids = new Uint8Array(dimensions[0] * dimensions[1] * dimensions[2]);
  let received = 0;
  await download(url, ids.length, (bytes) => {
    ids.set(bytes, received);
    received += bytes.length;
  });
  const labels = { ids, dimensions, bricks: labelledBricks(ids, dimensions) };
  tell({ kind: "labels", labels }, [ids.buffer]);
}

async function bringValues({ url, dimensions, step, meanwhile }: ValuesRequest): Promise<void> {
  const scan = new LoadingScan(dimensions);
  const standIn = meanwhile && new StandIn(meanwhile.coarse, dimensions, step, meanwhile.parts);
  if (standIn !== null) {
    void fillIn(scan, standIn, dimensions[2], meanwhile?.soon ?? 0);
  }
  await download(url, 2 * dimensions[0] * dimensions[1] * dimensions[2], (bytes) => {
    for (const planes of scan.take(bytes)) {
      tellPlanes(planes);
    }
    tellArrival(scan, standIn);
  });
  tell({ kind: "values", bricks: scan.bricks });
}

/** Hands on what stands in for planes that are not there soon. */
async function fillIn(scan: LoadingScan, standIn: StandIn, depth: number, soon: number): Promise<void> {
  const begun = performance.now();
  const left = (): number => ((performance.now() - begun) * (depth - scan.arrived)) / scan.arrived;
  do {
    await pause(lookMilliseconds);
  } while (left() < soon && scan.arrived < depth);
  for (let planes = standIn.make(scan.arrived); planes !== null; planes = standIn.make(scan.arrived)) {
    tellPlanes(planes);
    // what has arrived meanwhile is taken between two slabs
    await pause(0);
  }
  tellArrival(scan, standIn);
}

function tellArrival(scan: LoadingScan, standIn: StandIn | null): void {
  const arrival = standIn?.next(scan) ?? null;
  if (arrival !== null) {
    tell({ kind: "arrival", arrival });
  }
}

function pause(milliseconds: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, milliseconds));
}

onmessage = ({ data }: MessageEvent<VolumeRequest>) => {
  const work = data.kind === "labels" ? bringLabels(data) : bringValues(data);
  work.catch((error: unknown) => {
    tell({ kind: "failed", text: error instanceof Error ? error.message : String(error) });
  });
};
