/**
 * Who draws the 3-D view: this browser, or the engine, which is quicker where the browser's graphics are drawn by the
 * CPU. Always one of them alone.
 */
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
}

/** Why the engine cannot draw what is shown; null where it can. */
export function engineObstacle({ connected, stereo, second }: ShownThings): string | null {
  if (!connected) {
    return "the engine is not connected";
  }
  if (stereo !== "off") {
    return "stereo is shown";
  }
  if (second) {
    return "a second scan is shown";
  }
  return null;
}
