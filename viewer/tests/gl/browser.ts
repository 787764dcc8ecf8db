/**
 * A headless browser on the page of the GL tests, served from the sources.
 */
import type { Browser, Page } from "playwright-core";
import { createServer, type ViteDevServer } from "vite";
import { launchChromium } from "../../e2e/chromium.mjs";
import type {} from "./page";

export interface GlBrowser {
  readonly page: Page;
  readonly close: () => Promise<void>;
}

export async function openGlBrowser(): Promise<GlBrowser> {
  const server: ViteDevServer = await createServer({ logLevel: "error", server: { port: 0, host: "127.0.0.1" } });
  await server.listen();
  const browser: Browser = await launchChromium();
  const page = await browser.newPage();
  page.setDefaultTimeout(120_000);
  const errors: string[] = [];
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error") {
      errors.push(message.text());
    }
  });
  await page.goto(`${server.resolvedUrls?.local[0] ?? ""}tests/gl/page.html`);
  await page.waitForFunction(() => window.glTests !== undefined).catch((error: unknown) => {
    throw new Error(`the page did not start: ${errors.join("; ")}`, { cause: error });
  });
  return {
    page,
    close: async () => {
      await browser.close();
      await server.close();
    },
  };
}
