/**
 * Where a small card goes that speaks of something on the page: beside it, and never over the middle of the picture.
 * Places are CSS pixels of the page.
 */
import type { Rect } from "../view/picture_layout";

type Size = Pick<Rect, "width" | "height">;
type Corner = Pick<Rect, "x" | "y">;

/** Between the card and what it speaks of, and from the edges of page and picture. */
const gap = 10;
/** The middle of the picture is so much of its width and height. */
const middleShare = 0.5;

/** What must stay free counts so many times as much as what should. */
const dear = 1000;

export interface Surroundings {
  readonly page: Size;
  readonly picture: Rect | null;
  /** What the card speaks of; null is the picture. */
  readonly target: Rect | null;
  /** What it should leave free too. */
  readonly controls: readonly Rect[];
}

/** The upper left corner of a card of some size: the first place that covers least. */
export function cardPlace(card: Size, around: Surroundings): Corner {
  const { page, picture, target, controls } = around;
  const whole: Rect = { x: 0, y: 0, ...page };
  const wanted = [
    ...(target === null ? [] : sidesOf(target, card)),
    ...cornersOf(picture ?? whole, card),
    // a small picture has no room beside its middle
    ...(picture === null ? [] : sidesOf(picture, card)),
  ].map(({ x, y }) => ({ x: within(x, page.width - card.width), y: within(y, page.height - card.height) }));
  const free = [...(picture === null ? [] : [middleOf(picture)]), ...(target === null ? [] : [target])];
  const coveredOf = (corner: Corner, rects: readonly Rect[]): number =>
    rects.reduce((sum, rect) => sum + overlap({ ...card, ...corner }, rect), 0);
  // controls that are covered for a while can still be reached by Skip
  const covered = wanted.map((corner) => dear * coveredOf(corner, free) + coveredOf(corner, controls));
  return wanted[covered.indexOf(Math.min(...covered))] ?? { x: gap, y: gap };
}

/** The part of the picture that is looked at. */
export function middleOf({ x, y, width, height }: Rect): Rect {
  const margin = (1 - middleShare) / 2;
  return {
    x: x + margin * width,
    y: y + margin * height,
    width: middleShare * width,
    height: middleShare * height,
  };
}

/** Right, below, left, above. */
function sidesOf(target: Rect, card: Size): readonly Corner[] {
  const across = target.x + (target.width - card.width) / 2;
  return [
    { x: target.x + target.width + gap, y: target.y },
    { x: across, y: target.y + target.height + gap },
    { x: target.x - card.width - gap, y: target.y },
    { x: across, y: target.y - card.height - gap },
  ];
}

function cornersOf({ x, y, width, height }: Rect, card: Size): readonly Corner[] {
  const [left, right] = [x + gap, x + width - card.width - gap];
  const [top, bottom] = [y + gap, y + height - card.height - gap];
  return [
    { x: right, y: top },
    { x: right, y: bottom },
    { x: left, y: bottom },
    { x: left, y: top },
  ];
}

function within(place: number, most: number): number {
  return Math.max(gap, Math.min(place, most - gap));
}

/** The area that two rectangles share. */
export function overlap(a: Rect, b: Rect): number {
  const width = Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x);
  const height = Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y);
  return Math.max(0, width) * Math.max(0, height);
}
