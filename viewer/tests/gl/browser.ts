/**
 * A headless browser on the page of the GL tests.
 */
import type { Browser, Page } from "playwright-core";
import { inject } from "vitest";
import { launchChromium } from "../../e2e/chromium.mjs";
import type {} from "./page";
import type {} from "./server";

export interface GlBrowser {
  readonly page: Page;
  readonly close: () => Promise<void>;
}

/** @param flags for Chromium, beside the usual ones. */
export async function openGlBrowser(flags: readonly string[] = []): Promise<GlBrowser> {
  const browser: Browser = await launchChromium([...flags]);
  const page = await browser.newPage();
  page.setDefaultTimeout(120_000);
  const errors: string[] = [];
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error") {
      errors.push(message.text());
    }
  });
  await page.goto(inject("glPage"));
  await page.waitForFunction(() => window.glTests !== undefined).catch((error: unknown) => {
    throw new Error(`the page did not start: ${errors.join("; ")}`, { cause: error });
  });
  return { page, close: () => browser.close() };
}
