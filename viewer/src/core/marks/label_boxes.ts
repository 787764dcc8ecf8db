/** Labels of marks that keep apart from one another. Places are CSS pixels of a pane. */
import type { Viewport } from "../geometry/camera";
import { labelLine, letterWidth } from "./mark_lines";

/** What a label takes up. */
export interface LabelBox {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

interface Place {
  readonly x: number;
  readonly y: number;
}

/** What a label of some lines takes up; `place` is its first baseline. */
export function labelBox(place: Place, lines: readonly string[], enlarged = 1): LabelBox {
  const line = labelLine * enlarged;
  return {
    left: place.x,
    right: place.x + letterWidth * enlarged * Math.max(...lines.map(({ length }) => length)),
    top: place.y - line,
    bottom: place.y + line * (lines.length - 1) + 4,
  };
}

/**
 * Where a label goes so that it stands on none of those before it: the nearest place above or below them that is in
 * the pane; where there is none, it stays.
 */
export function clearOfLabels(place: Place, box: LabelBox, taken: readonly LabelBox[], { height }: Viewport): Place {
  const beside = taken.filter(({ left, right }) => left < box.right && right > box.left);
  const moves = [0, ...beside.flatMap(({ top, bottom }) => [bottom - box.top, top - box.bottom])];
  const free = moves.filter((down) => {
    const [top, bottom] = [box.top + down, box.bottom + down];
    const isIn = down === 0 || (top >= 0 && bottom <= height);
    return isIn && beside.every((other) => top >= other.bottom || bottom <= other.top);
  });
  const least = free.reduce((best, down) => (Math.abs(down) < Math.abs(best) ? down : best), free[0] ?? 0);
  return { x: place.x, y: place.y + least };
}
