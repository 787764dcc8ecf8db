/**
 * What of touch is drawn, whether it is felt now or was recorded.
 */
import type { State } from "../protocol";

/** What of touch the picture and the slices show. */
export type ShownTouch = Pick<
  State,
  "time" | "proxy" | "device" | "probe_radius" | "contact" | "contact_point" | "normal" | "force"
>;

/** What a recorded hand feels, in place of the one that feels now. */
export interface PlayedTouch extends ShownTouch {
  /** Where its tool is, as a sentence. */
  readonly words: string;
  /** Seconds before now (negative) and magnitudes of the force [N] of so many seconds, the oldest first. */
  readonly series: (seconds: number) => readonly [number[], number[]];
}
