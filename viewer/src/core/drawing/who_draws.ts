/**
 * Who draws the 3-D view: this browser, or the engine, which is mostly quicker where the browser's graphics are drawn
 * by the CPU. Always one of them alone.
 */
import type { Named } from "../appearance/picture_names";
import type { Segment } from "../protocol";
import { drawnAsSurface } from "../segments/shown_segments";
import type { Fusion } from "../second/second_scan";
import type { Drawer } from "./quicker_drawer";

export const drawerChoices = ["auto", "browser", "engine"] as const;
export type DrawerChoice = (typeof drawerChoices)[number];

export const drawerNames: Readonly<Record<DrawerChoice, Named>> = {
  auto: { name: "Automatic", title: "This browser where it has a graphics card, else whichever is quicker: measured" },
  browser: { name: "This browser", title: "Pictures are drawn by this browser's graphics" },
  engine: { name: "Engine", title: "Pictures are drawn by the engine, where it can draw all that is shown" },
};

/** A choice that was kept, where it can be one. */
export function saneDrawer(kept: unknown): DrawerChoice {
  return drawerChoices.find((choice) => choice === kept) ?? "auto";
}

/** Whom a person would have draw; where the CPU draws in this browser, the quicker of both. */
export function wantsEngine(choice: DrawerChoice, software: boolean, quicker: Drawer = "engine"): boolean {
  return choice === "auto" ? software && quicker === "engine" : choice === "engine";
}

/** Seconds after which an engine is tried again whose pictures did not come. */
export const retrySeconds = 30;

/** What is shown, as far as it tells whether the engine can draw it. */
export interface ShownThings {
  readonly connected: boolean;
  /** Why the engine's pictures do not come; null where they do. */
  readonly failure: string | null;
  /** How the view shows a second scan; null where it shows none. */
  readonly second: Fusion | null;
  readonly deforming: boolean;
  readonly segments: readonly Segment[];
}

/** Why the engine cannot draw what is shown; null where it can. */
export function engineObstacle(shown: ShownThings): string | null {
  const { connected, failure, second, deforming, segments } = shown;
  if (!connected) {
    return "the engine is not connected";
  }
  if (failure !== null) {
    return `${failure}; the engine is tried again every ${String(retrySeconds)} s`;
  }
  if (second !== null && second !== "blend") {
    return "two scans are shown by turns";
  }
  if (deforming && segments.some(drawnAsSurface)) {
    return "a surface is shown while soft tissue is deformed";
  }
  return null;
}
