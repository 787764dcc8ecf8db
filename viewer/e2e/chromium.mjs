/**
 * The installed Chromium, headless, with WebGL2 drawn by the CPU: the same on every machine.
 */
import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

const candidates = [
  "/usr/bin/chromium-headless-shell",
  "/usr/bin/chromium",
  "/usr/bin/chromium-browser",
  "/usr/bin/google-chrome",
];

const flags = [
  "--no-sandbox",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--no-first-run",
];

/** Path of the browser; PALPATE_CHROMIUM or CHROMIUM names another one. */
export function chromiumPath() {
  const given = process.env["PALPATE_CHROMIUM"] ?? process.env["CHROMIUM"];
  const found = given ?? candidates.find((path) => existsSync(path));
  if (found === undefined || !existsSync(found)) {
    throw new Error(
      `no Chromium at ${given ?? candidates.join(", ")}: install it ("apt-get install chromium") ` +
        "or name one in PALPATE_CHROMIUM",
    );
  }
  return found;
}

/** Starts it with a fresh profile. */
export function launchChromium(moreFlags = []) {
  return chromium.launch({ executablePath: chromiumPath(), headless: true, args: [...flags, ...moreFlags] });
}
