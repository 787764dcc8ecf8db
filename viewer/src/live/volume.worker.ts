/**
 * Downloads voxels and prepares them for the picture, off the page's thread.
 */
import { labelledBricks, noRanges, widenRanges } from "../core/bricks";
import { biasInPlace } from "../core/stored_values";
import type { VolumeAnswer, VolumeRequest } from "./volume_messages";

function tell(answer: VolumeAnswer, transfer: Transferable[] = []): void {
  postMessage(answer, { transfer });
}

/** Receives exactly `size` bytes, with progress; `took` is told how many are there by now. */
async function download(
  url: string,
  size: number,
  took: (bytes: Uint8Array<ArrayBuffer>, received: number) => void = () => undefined,
): Promise<Uint8Array<ArrayBuffer>> {
  const response = await fetch(url, { cache: "no-store" });
  if (!response.ok || response.body === null) {
    throw new Error(`the engine answered ${String(response.status)} ${response.statusText}`);
  }
  const bytes = new Uint8Array(size);
  let received = 0;
  for (const reader = response.body.getReader(); ; ) {
    const { done, value } = await reader.read();
    if (done) {
      break;
    }
    if (received + value.length > size) {
      throw new Error(`the engine sent more than the ${String(size)} bytes of this scan`);
    }
    bytes.set(value, received);
    received += value.length;
    took(bytes, received);
    tell({ kind: "progress", share: received / size });
  }
  if (received < size) {
    throw new Error(`the engine sent ${String(received)} of ${String(size)} bytes`);
  }
  return bytes;
}

async function answer({ kind, url, dimensions }: VolumeRequest): Promise<void> {
  const voxels = dimensions[0] * dimensions[1] * dimensions[2];
  if (kind === "labels") {
    const ids = await download(url, voxels);
    const labels = { ids, dimensions, bricks: labelledBricks(ids, dimensions) };
    tell({ kind: "labels", labels }, [ids.buffer]);
    return;
  }
  const bricks = noRanges(dimensions);
  const plane = dimensions[0] * dimensions[1];
  let done = 0;
  // planes that are whole are worked on while the next ones are on their way
  const bytes = await download(url, 2 * voxels, ({ buffer }, received) => {
    const whole = Math.floor(received / (2 * plane));
    if (whole > done) {
      const values = new Uint16Array(buffer);
      biasInPlace(values.subarray(plane * done, plane * whole));
      widenRanges(bricks, { dimensions, values }, done, whole);
      done = whole;
    }
  });
  const values = new Uint16Array(bytes.buffer);
  tell({ kind: "values", values, bricks }, [values.buffer]);
}

onmessage = (event: MessageEvent<VolumeRequest>) => {
  answer(event.data).catch((error: unknown) => {
    tell({ kind: "failed", text: error instanceof Error ? error.message : String(error) });
  });
};
