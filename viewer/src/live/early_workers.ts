/**
 * Workers that a page needs as soon as it is there. They start while it looks at the graphics: each takes about as
 * long to start as the engine to answer.
 */
type Kind = "connection" | "volume";

const make: Readonly<Record<Kind, () => Worker>> = {
  connection: () => new Worker(new URL("./connection.worker.ts", import.meta.url), { type: "module" }),
  volume: () => new Worker(new URL("./volume.worker.ts", import.meta.url), { type: "module" }),
};

const waiting = new Map<Kind, Worker>();

/** Starts a worker of each kind before there is work for it. */
export function startWorkers(): void {
  for (const kind of ["connection", "volume"] as const) {
    if (!waiting.has(kind)) {
      waiting.set(kind, make[kind]());
    }
  }
}

/** The worker that waits, else a new one; it belongs to who takes it. */
export function takeWorker(kind: Kind): Worker {
  const worker = waiting.get(kind) ?? make[kind]();
  waiting.delete(kind);
  return worker;
}
