/**
 * Who draws the 3-D view: this browser, or the engine, which is mostly quicker where the browser's graphics are drawn
 * by the CPU. Always one of them alone.
 */
import { formatValue } from "../base/format";
import type { Named } from "../appearance/picture_names";
import type { Drawer } from "./quicker_drawer";

export const drawerChoices = ["auto", "browser", "engine"] as const;
export type DrawerChoice = (typeof drawerChoices)[number];

export const drawerNames: Readonly<Record<DrawerChoice, Named>> = {
  auto: { name: "Automatic", title: "This browser where it has a graphics card, else whichever is quicker: measured" },
  browser: { name: "This browser", title: "Pictures are drawn by this browser's graphics" },
  engine: { name: "Engine", title: "Pictures are drawn by the engine" },
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

/** Whether there is an engine that draws. */
export interface EngineReach {
  readonly connected: boolean;
  /** Why the engine's pictures do not come; null where they do. */
  readonly failure: string | null;
}

/** Why the engine does not draw; null where it can. */
export function engineObstacle({ connected, failure }: EngineReach): string | null {
  if (!connected) {
    return "the engine is not connected";
  }
  return failure === null ? null : `${failure}; the engine is tried again every ${formatValue(retrySeconds, "s")}`;
}
