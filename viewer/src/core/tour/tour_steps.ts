/**
 * The tour for a person who is here for the first time: six steps, what each of them says, and when it has been done.
 */
import type { ToolState } from "../protocol";
import { dot, type Vec3 } from "../geometry/vector";

export const stepNames = ["open", "turn", "touch", "threshold", "drill", "undo"] as const;
export type StepName = (typeof stepNames)[number];

/** What a step speaks of: the first of these that is seen, and what to do there. */
export interface StepPlace {
  /** Selector of an element; null is the picture. */
  readonly at: string | null;
  readonly says: string;
}

export interface TourStep {
  readonly title: string;
  readonly places: readonly StepPlace[];
}

const picture = null;

export const tourSteps: Readonly<Record<StepName, TourStep>> = {
  open: {
    title: "Open a scan",
    places: [
      { at: "[data-testid=open-page]", says: "Drop its files or its folder anywhere on this page, or choose it." },
    ],
  },
  turn: {
    title: "Turn it",
    places: [{ at: picture, says: "Drag over the picture with the left button. The wheel brings it nearer." }],
  },
  touch: {
    title: "Touch it",
    places: [
      {
        at: "[data-testid=touch-mode][aria-pressed=true]",
        says: "Now press with the left button on the picture, and drag: the amber arrow is the force.",
      },
      { at: "[data-testid=touch-mode]", says: "Press this button, or the key T: the mouse then touches." },
    ],
  },
  threshold: {
    title: "Choose what is felt",
    places: [
      {
        at: ".left .threshold",
        says: "All voxels with values in this range are felt. Drag one of its two handles.",
      },
      {
        at: "[data-testid=add-threshold]",
        says: "Press this button, or open a segment in the list: its range of values is what is felt.",
      },
      { at: "[data-testid=group-segments]", says: "Choose this group: it says what can be felt." },
      { at: "[data-testid=panel-left]", says: "Open this panel: it says what can be felt." },
    ],
  },
  drill: {
    title: "Drill",
    places: [
      {
        at: "[data-testid=tool-card][data-tool=drill]",
        says: "In touch mode (T), hold Shift and press with the left button on what you see. It is drilled away.",
      },
      { at: "[data-testid=tool-drill]", says: "Take the drill." },
      { at: "[data-testid=panel-right]", says: "Open this panel, or press D: the tools are in it." },
    ],
  },
  undo: {
    title: "Take it back",
    places: [
      {
        at: "[data-testid=undo]",
        says: "Press this button, or Ctrl+Z: every change can be taken back. The help (?) shows this tour again.",
      },
    ],
  },
};

/** What the page knows, as far as the steps ask for it. */
export interface TourMoment {
  /** Toward the viewer, a unit vector; null before there is a picture. */
  readonly back: Vec3 | null;
  readonly contact: boolean;
  /** Ranges of all segments by threshold, as text. */
  readonly ranges: string;
  readonly tool: Pick<ToolState, "kind" | "on" | "voxels"> | null;
  readonly canRedo: boolean;
}

/** The view has turned when it has by this angle, as its cosine: 6 degrees. */
const turned = Math.cos((6 * Math.PI) / 180);

/** Whether a step has been done between two moments. */
export function isDone(step: StepName, before: TourMoment, now: TourMoment): boolean {
  switch (step) {
    case "open":
      // the page loads itself anew with the scan
      return false;
    case "turn":
      return before.back !== null && now.back !== null && dot(before.back, now.back) < turned;
    case "touch":
      return now.contact && !before.contact;
    case "threshold":
      return now.ranges !== before.ranges;
    case "drill":
      return now.tool?.kind === "drill" && now.tool.on && now.tool.voxels > 0;
    case "undo":
      return now.canRedo && !before.canRedo;
  }
}

/** What a step began with, once this is so: what has ended since can be begun again. */
export function since(before: TourMoment, now: TourMoment): TourMoment {
  return {
    ...before,
    back: before.back ?? now.back,
    contact: before.contact && now.contact,
    canRedo: before.canRedo && now.canRedo,
  };
}
