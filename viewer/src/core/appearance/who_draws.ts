/**
 * Who draws the 3-D view: this browser, or the engine, which is quicker where the browser's graphics are drawn by the
 * CPU. Always one of them alone.
 */
import type { Segment } from "../protocol";
import { drawnAsSurface } from "../segments/shown_segments";
import type { Stereo } from "../view/stereo";

export const drawerChoices = ["auto", "browser", "engine"] as const;
export type DrawerChoice = (typeof drawerChoices)[number];

/** A choice that was kept, where it can be one. */
export function saneDrawer(kept: unknown): DrawerChoice {
  return drawerChoices.find((choice) => choice === kept) ?? "auto";
}

/** Whom a person would have draw. */
export function wantsEngine(choice: DrawerChoice, software: boolean): boolean {
  return choice === "auto" ? software : choice === "engine";
}

/** What is shown, as far as it tells whether the engine can draw it. */
export interface ShownThings {
  readonly connected: boolean;
  readonly stereo: Stereo["mode"];
  readonly second: boolean;
  readonly deforming: boolean;
  readonly segments: readonly Segment[];
}

/** Why the engine cannot draw what is shown; null where it can. */
export function engineObstacle({ connected, stereo, second, deforming, segments }: ShownThings): string | null {
  if (!connected) {
    return "the engine is not connected";
  }
  if (stereo !== "off") {
    return "stereo is shown";
  }
  if (second) {
    return "a second scan is shown";
  }
  if (deforming && segments.some(drawnAsSurface)) {
    return "a surface is shown while soft tissue is deformed";
  }
  return null;
}
