import { expect, test } from "vitest";
import { ContactSound, type Heard, type Sound } from "../../../src/core/touch/contact_sound";
import type { Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";

const up: Vec3 = [0, 0, 1];
const free: Heard = {
  time: 0,
  device: [0, 0, 5],
  proxy: [0, 0, 5],
  normal: [0, 0, 0],
  force: [0, 0, 0],
  contact: false,
};
const frame = 1 / 60;

/** The sound when a hand falls at a speed [mm/s] onto z = 0. */
function fall(speed: number, stiffness: number): Sound {
  const sound = new ContactSound();
  sound.next({ ...free, device: [0, 0, 0.5 * speed * frame] }, stiffness);
  const depth = 0.5 * speed * frame;
  const touching = { ...free, time: frame, contact: true, normal: up, proxy: [0, 0, 0] as const };
  return sound.next({ ...touching, device: [0, 0, -depth], force: [0, 0, stiffness * depth] }, stiffness);
}

/** The scrape of a probe that slides at a speed [mm/s] under a force [N]. */
function slide(speed: number, force: number, stiffness = 1): Sound {
  const sound = new ContactSound();
  const at = (i: number): Heard => {
    const proxy: Vec3 = [i * speed * frame, 0, 0];
    return { time: i * frame, device: proxy, proxy, normal: up, force: [0, 0, force], contact: true };
  };
  sound.next(at(0), stiffness);
  sound.next(at(1), stiffness);
  return sound.next(at(2), stiffness);
}

test("the faster the hand falls, the louder the strike, up to a limit", () => {
  const gains = [5, 20, 80, 250, 1000].map((speed) => fall(speed, 1).strike?.gain ?? 0);
  expect([...gains].sort((a, b) => a - b)).toEqual(gains);
  expect(gains[0]).toBeGreaterThan(0);
  expect(gains.slice(-2)).toEqual([1, 1]);
});

test("a hand laid down gently makes no sound", () => {
  expect(fall(1, 1).strike).toBeNull();
});

test("stiff surfaces strike brighter and shorter than soft ones", () => {
  const [soft, stiff] = [fall(100, 0.1).strike, fall(100, 4).strike];
  expect(stiff?.frequency).toBeGreaterThan(3 * (soft?.frequency ?? Infinity));
  expect(stiff?.seconds).toBeLessThan(soft?.seconds ?? 0);
  expect(stiff?.gain).toBe(soft?.gain);
});

test("contact that only flickers strikes once", () => {
  const sound = new ContactSound();
  let strikes = 0;
  for (let i = 0; i < 40; ++i) {
    const contact = i >= 10 && i % 2 === 0;
    const device: Vec3 = [0, 0, 5 - 0.5 * i];
    strikes += sound.next({ ...free, time: i * frame, device, normal: contact ? up : [0, 0, 0], contact }, 1).strike
      ? 1
      : 0;
  }
  expect(strikes).toBe(1);
});

test("the scrape follows sliding speed and force, and is silent at rest", () => {
  expect(slide(0, 3).scrape.gain).toBe(0);
  expect(slide(50, 0).scrape.gain).toBe(0);
  expect(slide(50, 2).scrape.gain).toBeGreaterThan(slide(20, 2).scrape.gain);
  expect(slide(50, 2).scrape.gain).toBeGreaterThan(slide(50, 0.5).scrape.gain);
  expect(slide(80, 2).scrape.frequency).toBeGreaterThan(slide(10, 2).scrape.frequency);
  expect(slide(50, 2, 4).scrape.frequency).toBeGreaterThan(slide(50, 2, 0.1).scrape.frequency);
});

test("moving off the surface is no sliding", () => {
  const sound = new ContactSound();
  sound.next({ ...free, contact: true, normal: up, force: [0, 0, 1] }, 1);
  const lifted = sound.next({ ...free, time: frame, proxy: [0, 0, 6], contact: true, normal: up, force: [0, 0, 1] }, 1);
  expect(lifted.scrape.gain).toBe(0);
});

test("after a pause, or in a new session, nothing is heard of the jump", () => {
  for (const time of [30, -10]) {
    const sound = new ContactSound();
    sound.next(free, 1);
    const after = sound.next({ ...free, time, device: [0, 0, -90], contact: true, normal: up, force: [0, 0, 4] }, 1);
    expect(after).toEqual({ strike: null, scrape: { gain: 0, frequency: after.scrape.frequency } });
  }
});

test("whatever arrives, gains and frequencies stay within what ears and filters take", () => {
  const random = new Random(71);
  const sound = new ContactSound();
  const point = (size: number): Vec3 => [
    random.between(-size, size),
    random.between(-size, size),
    random.between(-size, size),
  ];
  for (let i = 0; i < 2000; ++i) {
    const contact = random.between(0, 1) > 0.4;
    const state: Heard = {
      time: i * frame,
      device: point(1e6),
      proxy: point(1e6),
      normal: contact ? up : [0, 0, 0],
      force: point(50),
      contact,
    };
    const { strike, scrape } = sound.next(state, 10 ** random.between(-3, 2));
    for (const { gain, frequency } of strike === null ? [scrape] : [scrape, strike]) {
      expect(gain).toBeGreaterThanOrEqual(0);
      expect(gain).toBeLessThanOrEqual(1);
      expect(frequency).toBeGreaterThan(50);
      expect(frequency).toBeLessThan(8000);
    }
  }
});
