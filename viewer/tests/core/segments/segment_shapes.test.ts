import { describe, expect, it } from "vitest";
import { allowedAmount, choiceOf, shapeChoices } from "../../../src/core/segments/segment_shapes";

describe("ways to change a shape", () => {
  it("are each offered once, with a usual number that is allowed", () => {
    expect(new Set(shapeChoices.map(({ kind }) => kind)).size).toBe(shapeChoices.length);
    for (const { amount } of shapeChoices) {
      expect(allowedAmount(amount, undefined)).toBe(amount?.usual ?? 0);
    }
  });

  it("hold numbers where they can be", () => {
    const grow = choiceOf("grow").amount;
    expect(allowedAmount(grow, -4)).toBe(0.1);
    expect(allowedAmount(grow, 2.25)).toBe(2.25);
    expect(allowedAmount(grow, NaN)).toBe(2);
    expect(allowedAmount(choiceOf("keep-largest").amount, 2.4)).toBe(2);
    expect(allowedAmount(choiceOf("fill-holes").amount, 7)).toBe(0);
  });

  it("are the first one where what was remembered is not known", () => {
    expect(choiceOf("gone").kind).toBe("keep-largest");
  });
});
