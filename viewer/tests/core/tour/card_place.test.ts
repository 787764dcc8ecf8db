import { expect, test } from "vitest";
import { cardPlace, middleOf, overlap } from "../../../src/core/tour/card_place";
import { Random } from "../../support/random";

const page = { width: 1366, height: 768 };
const picture = { x: 288, y: 44, width: 806, height: 696 };
/** A card where it was before, as it is measured. */
const card = { x: 10, y: 10, width: 272, height: 140 };

test("the card stands beside what it speaks of, and covers nothing of it", () => {
  const target = { x: 1000, y: 8, width: 100, height: 28 };
  const place = cardPlace(card, { page, picture, target, controls: [] });
  expect(overlap({ ...card, ...place }, target)).toBe(0);
  // below, since there is no room to the right of it
  expect(place.y).toBeGreaterThan(target.y + target.height);
});

test("of the picture it speaks from a corner that is free of controls", () => {
  const free = cardPlace(card, { page, picture, target: null, controls: [] });
  expect([free.x + card.width, free.y]).toEqual([picture.x + picture.width - 10, picture.y + 10]);
  const controls = [{ x: free.x, y: free.y, width: 40, height: 40 }];
  const other = cardPlace(card, { page, picture, target: null, controls });
  expect(overlap({ ...card, ...other }, controls[0] ?? picture)).toBe(0);
});

test("it stays on the page and out of the middle of the picture, whatever it speaks of", () => {
  const random = new Random(5);
  for (const size of [page, { width: 900, height: 700 }, { width: 480, height: 800 }]) {
    const shown = { x: 0, y: 44, width: size.width, height: size.height - 72 };
    for (let i = 0; i < 300; ++i) {
      const [x, y] = [random.between(0, size.width - 40), random.between(0, size.height - 30)];
      const target = { x, y, width: 40, height: 30 };
      const corner = cardPlace(card, { page: size, picture: shown, target, controls: [] });
      const place = { ...card, ...corner };
      expect(place.x).toBeGreaterThanOrEqual(0);
      expect(place.y).toBeGreaterThanOrEqual(0);
      expect(place.x + place.width).toBeLessThanOrEqual(size.width);
      expect(place.y + place.height).toBeLessThanOrEqual(size.height);
      expect(overlap(place, middleOf(shown))).toBe(0);
    }
  }
});
