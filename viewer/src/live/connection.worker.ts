/**
 * The WebSocket to the engine, in a worker: arrival does not wait for the picture, and
 * states that the page is too busy to take are merged into the latest one.
 */
import { decodeToPage, encodeFromPage } from "../core/protocol";
import type { FromConnection, ToConnection } from "./connection_messages";
import { Mailbox, memoryOf } from "./mailbox";
import { PictureParts } from "./picture_parts";
import { lookEvery, SilenceWatch, type Silence } from "./silence";

const mailbox = new Mailbox();
const pictureParts = new PictureParts();
const watch = new SilenceWatch();
let socket: WebSocket | null = null;
let pageReady = true;

function tell(message: FromConnection, transfer: Transferable[] = []): void {
  postMessage(message, { transfer });
}

function tellSilence(silence: Silence | null): void {
  if (silence !== null) {
    tell({ kind: "silence", silence });
  }
}

function deliver(): void {
  const letters = mailbox.take(pageReady);
  if (letters.length > 0) {
    pageReady &&= letters.at(-1)?.message.type !== "state";
    tell({ kind: "batch", letters }, memoryOf(letters));
  }
}

function receive(packed: ArrayBuffer): void {
  const arrived = performance.timeOrigin + performance.now();
  tellSilence(watch.heard(performance.now()));
  try {
    const message = decodeToPage(packed);
    if (message.type === "picture_part") {
      // at once: the engine measures the way by it
      socket?.send(encodeFromPage({ type: "picture_taken" }));
      const picture = pictureParts.take(message);
      if (picture === null) {
        return;
      }
      mailbox.put(decodeToPage(picture), arrived);
    } else {
      mailbox.put(message, arrived);
    }
  } catch (error) {
    tell({ kind: "malformed", text: error instanceof Error ? error.message : String(error) });
    return;
  }
  deliver();
}

function open(url: string): void {
  const opening = new WebSocket(url);
  opening.binaryType = "arraybuffer";
  opening.onopen = () => {
    tell({ kind: "opened" });
  };
  opening.onmessage = (event: MessageEvent<ArrayBuffer>) => {
    receive(event.data);
  };
  opening.onclose = (event) => {
    socket = null;
    // delivered later, it would look like a sign of life
    mailbox.drop();
    tellSilence(watch.forget());
    tell({ kind: "closed", code: event.code, reason: event.reason });
  };
  socket = opening;
}

setInterval(() => {
  tellSilence(watch.look(performance.now()));
}, lookEvery);

onmessage = (event: MessageEvent<ToConnection>) => {
  const message = event.data;
  switch (message.kind) {
    case "open":
      open(message.url);
      break;
    case "send":
      if (socket?.readyState === WebSocket.OPEN) {
        socket.send(encodeFromPage(message.message));
      }
      break;
    case "taken":
      pageReady = true;
      deliver();
      break;
  }
};
