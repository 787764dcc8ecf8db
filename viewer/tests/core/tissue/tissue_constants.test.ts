import { expect, test } from "vitest";
import { described, customTissue, typed, writtenConstants, written } from "../../../src/core/tissue/tissue_constants";
import type { Constants } from "../../../src/core/protocol";

const liver: Constants = {
  young: 5500, poisson: 0.45, density: 1060,
  fracture_energy: 164, friction: 0.2, stiffening: 0,
};
const bone: Constants = {
  young: 18.6e9, poisson: 0.3, density: 1900,
  fracture_energy: null, friction: 0.3, stiffening: 0,
};

function of(key: keyof Constants): (typeof writtenConstants)[number] {
  const found = writtenConstants.find((each) => each.key === key);
  if (found === undefined) throw new Error(`${key} is not written`);
  return found;
}

test("each constant is written in its unit, and read back as it was", () => {
  const fields = writtenConstants.map((each) => written(each, liver));
  expect(fields).toEqual(["5.5", "0.45", "1.06", "164", "20", "0"]);
  expect(writtenConstants.map((each) => described(each, bone))).toEqual([
    "18\u2009600\u2009000\u202fkPa",
    "0.3",
    "1.9\u202fg/cm³",
    "never",
    "30\u202f%",
    "0",
  ]);
  for (const constants of [liver, bone, customTissue]) {
    for (const each of writtenConstants) {
      expect(typed(each, written(each, constants), customTissue)).toEqual({
        constants: { ...customTissue, [each.key]: constants[each.key] },
      });
    }
  }
});

test.each([
  ["young", "0", "Modulus E: it cannot be 0. Enter 0.001 to 2\u2009000\u2009000\u2009000\u202fkPa."],
  ["poisson", "0.5", "Poisson's ν: it cannot be 0.5. Enter −0.99 to 0.499."],
  ["density", "", "Density ρ: no number was entered. Enter 0.0001 to 23\u202fg/cm³."],
  [
    ...(["fracture_energy", "-3"] as const),
    "Fracture energy: it cannot be -3. Enter 0.01 to 1\u2009000\u2009000\u202fJ/m², or nothing for never.",
  ],
  ["friction", "soft", "Friction: it cannot be soft. Enter 0 to 1\u2009000\u202f%."],
  ["stiffening", "101", "Stiffening b: it cannot be 101. Enter 0 to 100."],
] as const)("%s of %o is refused with what is allowed", (key, text, refused) => {
  expect(typed(of(key), text, liver)).toEqual({ refused });
});

test("without a fracture energy nothing tears", () => {
  expect(typed(of("fracture_energy"), " ", liver)).toEqual({ constants: { ...liver, fracture_energy: null } });
});

test("what may be typed the engine takes", () => {
  const engine = {
    young: [1, 2e12],
    poisson: [-0.999999, 0.499999],
    density: [0.1, 23_000],
    fracture_energy: [1e-9, 1e6],
    friction: [0, 10],
    stiffening: [0, 100],
  };
  for (const { key, scale, min, max } of writtenConstants) {
    const [low = NaN, high = NaN] = engine[key];
    expect([min * scale >= low * (1 - 1e-9), max * scale <= high * (1 + 1e-9)], key).toEqual([true, true]);
  }
});
