/**
 * One server of the page of the GL tests for all files of tests: two that started side by side would both
 * prepare the libraries, in one folder.
 */
import { createServer } from "vite";
import type { TestProject } from "vitest/node";

declare module "vitest" {
  interface ProvidedContext {
    /** Address of the page. */
    readonly glPage: string;
  }
}

export default async function serve(project: TestProject): Promise<() => Promise<void>> {
  const server = await createServer({ logLevel: "error", server: { port: 0, host: "127.0.0.1" } });
  await server.listen();
  await server.warmupRequest("/tests/gl/page.ts");
  project.provide("glPage", `${server.resolvedUrls?.local[0] ?? ""}tests/gl/page.html`);
  return () => server.close();
}
