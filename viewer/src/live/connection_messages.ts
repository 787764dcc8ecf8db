/**
 * What page and connection worker say to each other.
 */
import type { FromPage } from "../core/protocol";
import type { Letter } from "./mailbox";
import type { Silence } from "./silence";

export type ToConnection =
  | { readonly kind: "open"; readonly url: string }
  | { readonly kind: "send"; readonly message: FromPage }
  /** The page has taken the last state and is ready for the next. */
  | { readonly kind: "taken" };

export type FromConnection =
  | { readonly kind: "opened" }
  /** How long the engine has been silent, where that has changed. */
  | { readonly kind: "silence"; readonly silence: Silence }
  | { readonly kind: "batch"; readonly letters: readonly Letter[] }
  /** The socket has closed. */
  | { readonly kind: "closed"; readonly code: number; readonly reason: string }
  /** Something arrived that is not of the protocol. */
  | { readonly kind: "malformed"; readonly text: string };
