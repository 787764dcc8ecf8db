/**
 * Asks the engine for scans: work that tells how far it is, and files that are brought to it.
 */
import type { LaidOut } from "../core/library/headerless";
import type { About, GivenFile, JobLine } from "../core/library/library";
import type { AskedReconstruction, ReconstructionGrid } from "../core/library/reconstruction";
import type { Vec3 } from "../core/geometry/vector";
import { apiAddress } from "./connection";
import { job, type Asking } from "./job";

/** How many files are on their way at once. */
const atOnce = 4;

export async function askAbout(): Promise<About> {
  const answer = await fetch(apiAddress("/api/library/"), { cache: "no-store" });
  if (!answer.ok) {
    throw new Error(await answer.text());
  }
  return (await answer.json()) as About;
}

export async function forgetRecent(): Promise<void> {
  await fetch(apiAddress("/api/library/recent"), { method: "DELETE" });
}

/** Has the engine work on what the library has; see `job`. */
export async function work(
  route: "coming" | "find" | "open" | "pictures" | "reconstruct" | "segments" | "volume",
  wanted: object,
  asking: Asking,
  told: (line: JobLine) => void,
): Promise<void> {
  await job(`/api/library/${route}`, wanted, asking, told);
}

/** Asks for the grid of the scan that projections would give. Throws why they would give none. */
export async function askGrid(
  wanted: AskedReconstruction,
): Promise<ReconstructionGrid> {
  return (await asked("reconstruct/grid", wanted)) as ReconstructionGrid;
}

/** Asks for the scan that files would give by a layout. Throws why they would give none. */
export async function askLayout(
  wanted: { readonly find: number; readonly raw: string | null; readonly voxel_size: Vec3 | null },
): Promise<LaidOut> {
  return (await asked("layout", wanted)) as LaidOut;
}

async function asked(route: string, wanted: object): Promise<unknown> {
  const answer = await fetch(apiAddress(`/api/library/${route}`), {
    method: "POST",
    body: JSON.stringify(wanted),
  });
  if (!answer.ok) {
    throw new Error(await answer.text());
  }
  return answer.json();
}

/** Brings files to the engine; returns the number of the upload. Throws why they were not taken. */
export async function bring(
  files: readonly GivenFile[],
  { signal }: Asking,
  progress: (bytes: number) => void,
): Promise<number> {
  const told = files.map(({ name, file }) => ({ name, size: file.size }));
  const answer = await fetch(apiAddress("/api/library/uploads"), {
    method: "POST",
    body: JSON.stringify(told),
    signal,
  });
  if (!answer.ok) {
    throw new Error(await answer.text());
  }
  const { upload } = (await answer.json()) as { readonly upload: number };
  const place = `/api/library/uploads/${String(upload)}`;
  const brought = files.map(() => 0);
  const waiting = files.map(({ file }, number) => ({ file, number }));
  const bringNext = async (): Promise<void> => {
    for (let next = waiting.shift(); next !== undefined; next = waiting.shift()) {
      const { file, number } = next;
      await put(apiAddress(`${place}/${String(number)}`), file, signal, (bytes) => {
        brought[number] = bytes;
        progress(brought.reduce((sum, each) => sum + each, 0));
      });
    }
  };
  try {
    await Promise.all(Array.from({ length: atOnce }, bringNext));
  } catch (error) {
    waiting.length = 0;
    void dropUpload(upload);
    throw error;
  }
  return upload;
}

/** Has the engine forget files that were brought to it. */
export async function dropUpload(upload: number): Promise<void> {
  await fetch(apiAddress(`/api/library/uploads/${String(upload)}`), { method: "DELETE" });
}

/** `fetch` does not tell how much of a large file was sent. */
function put(url: string, file: Blob, signal: AbortSignal, progress: (bytes: number) => void): Promise<void> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("PUT", url);
    request.upload.onprogress = ({ loaded }) => {
      progress(loaded);
    };
    request.onload = () => {
      if (request.status === 204) {
        progress(file.size);
        resolve();
      } else {
        reject(new Error(request.responseText));
      }
    };
    request.onerror = () => {
      reject(new Error("a file could not be read, or the engine does not answer"));
    };
    request.onabort = () => {
      reject(new DOMException("cancelled", "AbortError"));
    };
    signal.addEventListener("abort", () => {
      request.abort();
    });
    signal.throwIfAborted();
    request.send(file);
  });
}
