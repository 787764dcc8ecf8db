import { expect, test } from "vitest";
import type { Changed, State, ToPage } from "../../src/core/protocol";
import { Mailbox, memoryOf } from "../../src/live/mailbox";

function state(tick: number, samples: State["samples"] = []): ToPage {
  return { type: "state", tick, samples } as unknown as State;
}

test("of waiting states the latest is delivered, with the samples of all", () => {
  const mailbox = new Mailbox();
  mailbox.put(state(1, [[0.1, 1, 0, 0]]));
  mailbox.put(state(2, [[0.2, 2, 0, 0]]));
  const delivered = mailbox.take(true)[0]?.message as State;
  expect(delivered.tick).toBe(2);
  expect(delivered.samples).toEqual([[0.1, 1, 0, 0], [0.2, 2, 0, 0]]);
  expect(mailbox.take(true)).toEqual([]);
});

test("a page that is busy is told of edits at once, and of the state when it is ready", () => {
  const mailbox = new Mailbox();
  const notice: ToPage = { type: "notice", level: "info", text: "edit" };
  mailbox.put(state(1));
  mailbox.put(notice);
  expect(mailbox.take(false).map(({ message }) => message.type)).toEqual(["notice"]);
  mailbox.put(state(2));
  expect(mailbox.take(false)).toEqual([]);
  expect(mailbox.take(true).map(({ message }) => (message as State).tick)).toEqual([2]);
});

test("no other message is lost or overtaken by another of its kind", () => {
  const mailbox = new Mailbox();
  const notice = (text: string): ToPage => ({ type: "notice", level: "info", text });
  mailbox.put(notice("first"));
  mailbox.put(state(1));
  mailbox.put(notice("second"));
  expect(mailbox.take(true).map(({ message }) => (message.type === "notice" ? message.text : message.type))).toEqual([
    "first",
    "second",
    "state",
  ]);
});

test("a page that sleeps for minutes gets a bounded number of samples", () => {
  const mailbox = new Mailbox();
  for (let i = 0; i < 5000; ++i) {
    mailbox.put(state(i, [[i / 250, 0, 0, 0], [i / 250 + 0.002, 0, 0, 0]]));
  }
  const delivered = mailbox.take(true)[0]?.message as State;
  expect(delivered.samples).toHaveLength(1500);
  expect(delivered.samples.at(-1)?.[0]).toBeCloseTo(4999 / 250 + 0.002);
});

test("a letter tells when it arrived; of merged states the latest", () => {
  const mailbox = new Mailbox();
  mailbox.put({ type: "notice", level: "info", text: "edit" }, 5);
  mailbox.put(state(1), 6);
  mailbox.put(state(2), 7);
  expect(mailbox.take(true).map(({ arrived }) => arrived)).toEqual([5, 7]);
});

test("the bytes of an edit are handed over once, however many lie in the same memory", () => {
  const memory = new ArrayBuffer(64);
  const part = (from: number): Uint8Array => new Uint8Array(memory, from, 6);
  const patch = {
    index: [0, 0, 0],
    origin: [0, 0, 0],
    size: [1, 1, 1],
    vertices: part(1),
    normals: part(8),
    triangles: part(20),
  } as const;
  const message: Changed = {
    type: "changed",
    edit: 1,
    applied: null,
    voxels: [{ low: [0, 0, 0], high: [1, 1, 3], stored: part(40), labels: null }],
    surfaces: [{ id: 1, whole: false, dropped: [], patches: [patch, patch] }],
    displaced: [{ origin: [0, 0, 0], step: [1, 1, 1], size: [1, 1, 1], moved: part(50) }],
  };
  expect(memoryOf([{ message, arrived: 0 }, { message: state(1), arrived: 0 }])).toEqual([memory]);
});

test("no state of an engine that is gone is delivered to a page that was busy", () => {
  const mailbox = new Mailbox();
  mailbox.put(state(1));
  expect(mailbox.take(false)).toEqual([]);
  mailbox.drop();
  expect(mailbox.take(true)).toEqual([]);
});
