/** A scan is read again at once, or after it was asked whether changes that are kept nowhere may go. */
import { expect, test } from "vitest";
import type { Library, Wanted } from "../../../../src/ui/features/library/library.svelte";
import { Rereader } from "../../../../src/ui/features/library/rereader.svelte";

/** A library whose open scan has changes, and what it was asked to read. */
function library(changed: boolean, kept: boolean, failure: string | null = null): { library: Library; read: Wanted[] } {
  const read: Wanted[] = [];
  const made = {
    about: null as object | null,
    work: null,
    failure: null as string | null,
    async look(): Promise<void> {
      await Promise.resolve();
      this.about = { changed, kept };
    },
    async reread(wanted: Wanted): Promise<void> {
      await Promise.resolve();
      read.push(wanted);
      this.failure = failure;
    },
  };
  return { library: made as unknown as Library, read };
}

test.each([
  [false, false],
  [true, true],
])("nothing is asked where no change is lost", async (changed, kept) => {
  const { library: asked, read } = library(changed, kept);
  const rereader = new Rereader(asked, false);
  await rereader.ask({ number: 2 });
  expect(read).toEqual([{ number: 2 }]);
  expect(rereader.doubted).toBeNull();
});

test("changes that are kept nowhere are asked about, but not for the second scan", async () => {
  const { library: asked, read } = library(true, false);
  const rereader = new Rereader(asked, false);
  await rereader.ask({ unit: "HU" });
  expect(read).toEqual([]);
  expect(rereader.doubted).toEqual({ unit: "HU" });
  await rereader.read({ unit: "HU" });
  expect(read).toEqual([{ unit: "HU" }]);
  expect(rereader.doubted).toBeNull();
  await new Rereader(asked, true).ask({ number: 3 });
  expect(read[1]).toEqual({ number: 3 });
});

test("a failure is shown where it was asked for", async () => {
  const { library: asked } = library(false, false, "The file is gone.");
  const here = new Rereader(asked, false);
  const elsewhere = new Rereader(asked, false);
  await here.ask({ orientation: "LPS" });
  expect(here.failure).toBe("The file is gone.");
  expect(elsewhere.failure).toBeNull();
});
