/**
 * What of touch is drawn, whether it is felt now or was recorded.
 */
import type { State } from "../protocol";

/** What of touch the picture and the slices show. */
export type ShownTouch = Pick<
  State,
  "time" | "proxy" | "device" | "probe_radius" | "contact" | "contact_point" | "normal" | "force"
>;
