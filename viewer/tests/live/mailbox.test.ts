import { expect, test } from "vitest";
import type { State, ToPage } from "../../src/core/protocol";
import { Mailbox } from "../../src/live/mailbox";

function state(tick: number, samples: State["samples"] = []): ToPage {
  return { type: "state", tick, samples } as unknown as State;
}

test("of waiting states the latest is delivered, with the samples of all", () => {
  const mailbox = new Mailbox();
  mailbox.put(state(1, [[0.1, 1, 0, 0]]));
  mailbox.put(state(2, [[0.2, 2, 0, 0]]));
  const [delivered] = mailbox.take() as [State];
  expect(delivered.tick).toBe(2);
  expect(delivered.samples).toEqual([[0.1, 1, 0, 0], [0.2, 2, 0, 0]]);
  expect(mailbox.take()).toEqual([]);
});

test("no other message is lost or overtaken by another of its kind", () => {
  const mailbox = new Mailbox();
  const notice = (text: string): ToPage => ({ type: "notice", level: "info", text });
  mailbox.put(notice("first"));
  mailbox.put(state(1));
  mailbox.put(notice("second"));
  expect(mailbox.take().map((message) => (message.type === "notice" ? message.text : message.type))).toEqual([
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
  const [delivered] = mailbox.take() as [State];
  expect(delivered.samples).toHaveLength(1500);
  expect(delivered.samples.at(-1)?.[0]).toBeCloseTo(4999 / 250 + 0.002);
});
