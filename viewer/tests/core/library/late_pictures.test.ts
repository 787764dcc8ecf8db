/** Pictures that are asked for as they are seen: one request at a time, the newest wish first, none twice. */
import { expect, test } from "vitest";
import type { JobLine } from "../../../src/core/library/library";
import { LatePictures } from "../../../src/core/library/late_pictures";

/** Pictures whose requests end when they are told to. */
function pictures(): { late: LatePictures; asked: number[][]; came: number[]; answer: () => Promise<void> } {
  const asked: number[][] = [];
  const came: number[] = [];
  let answer = (): void => undefined;
  const late = new LatePictures(
    (choices, _, told) => {
      asked.push([...choices]);
      return new Promise((resolve) => {
        answer = () => {
          for (const choice of choices) told({ kind: "picture", choice, png: "" });
          resolve();
        };
      });
    },
    (line: JobLine) => {
      if (line.kind === "picture") came.push(line.choice);
    },
  );
  return {
    late,
    asked,
    came,
    answer: async () => {
      answer();
      await new Promise((resolve) => setTimeout(resolve, 0));
    },
  };
}

test("the newest wish goes first, and what is out of sight is left out", async () => {
  const { late, asked, came, answer } = pictures();
  late.want(40);
  for (const choice of [41, 42, 43, 44, 45, 46]) late.want(choice);
  late.leave(44);
  await answer();
  expect(asked).toEqual([[40], [46, 45, 43, 42]]);
  await answer();
  await answer();
  expect(asked[2]).toEqual([41]);
  expect(came).toEqual([40, 46, 45, 43, 42, 41]);
});

test("none is asked for twice, and none once the list is gone", async () => {
  const { late, asked, answer } = pictures();
  late.want(40);
  late.want(40);
  await answer();
  late.want(40);
  late.want(41);
  late.want(42);
  late.end();
  await answer();
  expect(asked).toEqual([[40], [41]]);
});
