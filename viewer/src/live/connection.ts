/**
 * The page's end of the connection to the engine; opens it again by itself when it is lost.
 */
import type { FromPage, ToPage } from "../core/protocol";
import { takeWorker } from "./early_workers";
import type { FromConnection, ToConnection } from "./connection_messages";
import { Resumption } from "./resume";
import type { Silence } from "./silence";

export type ConnectionState =
  | { readonly kind: "connecting" }
  | { readonly kind: "open" }
  /** Lost; the next attempt follows by itself. */
  | { readonly kind: "lost"; readonly reason: string }
  /** The engine does not let this page in: it wants another cookie. */
  | { readonly kind: "refused" }
  /** The engine was started anew and has let this page in again: the page is to be loaded anew. */
  | { readonly kind: "restarted" }
  /** Palpate was stopped, or its session has ended; attempts follow by themselves until it is started again. */
  | { readonly kind: "ended" }
  /** Another scan has taken the place of this one: the page is to be loaded anew. */
  | { readonly kind: "exchanged" };

export interface ConnectionEvents {
  /** @param arrived when the engine's message was here, as `performance.now()` tells time. */
  readonly message: (message: ToPage, arrived: number) => void;
  readonly state: (state: ConnectionState) => void;
  readonly malformed: (text: string) => void;
  readonly silence: (silence: Silence) => void;
  /** The engine goes on after it stood still for some seconds: what it was asked meanwhile is not done. */
  readonly stoodStill: (seconds: string) => void;
}

/** Code with which the engine closes the connections of a scan that makes room for another. */
const exchanged = 4001;
/** Code with which an engine that stood still forgets what it was asked meanwhile; the reason is how long [s]. */
const stoodStill = 4002;
/** Code with which it closes where its session has ended, or Palpate is being stopped. */
const sessionEnded = 4003;
const firstRetry = 400;
const slowestRetry = 4000;

export class Connection {
  private readonly worker = takeWorker("connection");
  private readonly resumption: Resumption;
  private retry = firstRetry;
  /** It said that it ends; that holds until something comes again. */
  private ended = false;

  constructor(private readonly events: ConnectionEvents) {
    this.resumption = new Resumption(apiAddress("/api/resume/key"));
    this.worker.onmessage = (event: MessageEvent<FromConnection>) => {
      this.receive(event.data);
    };
    this.open();
  }

  send(message: FromPage): void {
    this.tell({ kind: "send", message });
  }

  close(): void {
    this.worker.terminate();
  }

  private receive(message: FromConnection): void {
    switch (message.kind) {
      case "opened":
        void this.resumption.learn();
        this.tellState({ kind: "open" });
        break;
      case "batch":
        this.retry = firstRetry;
        if (this.ended) {
          this.ended = false;
          this.tellState({ kind: "open" });
        }
        for (const letter of message.letters) {
          // worker and page count time from different beginnings
          this.events.message(letter.message, letter.arrived - performance.timeOrigin);
        }
        // a page in the background takes no states; the worker keeps the latest one for it
        if (message.letters.at(-1)?.message.type === "state") {
          requestAnimationFrame(() => {
            this.tell({ kind: "taken" });
          });
        }
        break;
      case "malformed":
        this.events.malformed(message.text);
        break;
      case "silence":
        this.events.silence(message.silence);
        break;
      case "closed":
        if (message.code === exchanged) {
          this.events.state({ kind: "exchanged" });
        } else if (message.code === sessionEnded) {
          this.tellState({ kind: "ended" });
          this.ended = true;
          // what answers until then may be what is ending
          setTimeout(() => {
            void this.reopen(message.reason);
          }, slowestRetry);
        } else if (message.code === stoodStill) {
          this.events.stoodStill(message.reason);
          this.open();
        } else {
          void this.reopen(message.reason);
        }
        break;
    }
  }

  private open(): void {
    this.tellState({ kind: "connecting" });
    this.tell({ kind: "open", url: liveAddress() });
  }

  private async reopen(reason: string): Promise<void> {
    // a refused WebSocket tells no reason, a refused page does
    const answer = await fetch(apiAddress("/"), { cache: "no-store" }).catch(() => null);
    if (answer?.status === 403) {
      const kind = (await this.resumption.resume()) ? "restarted" : "refused";
      this.events.state({ kind });
      return;
    }
    this.tellState({ kind: "lost", reason });
    setTimeout(() => {
      this.open();
    }, this.retry);
    this.retry = Math.min(slowestRetry, this.retry * 1.6);
  }

  /** Attempts after an end are no news. */
  private tellState(state: ConnectionState): void {
    if (!this.ended) {
      this.events.state(state);
    }
  }

  private tell(message: ToConnection): void {
    this.worker.postMessage(message);
  }
}

/** Address of a route of the engine, which the page's cookie opens. */
export function apiAddress(route: string): string {
  return new URL(route, window.location.origin).href;
}

function liveAddress(): string {
  const address = new URL(apiAddress("/api/live"));
  address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
  return address.href;
}
