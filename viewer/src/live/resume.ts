/**
 * Comes back to an engine that was started anew on this port, where another token holds.
 *
 * While it is let in, the page learns a key, and keeps it in memory only. Later engine and page show
 * each other that they know it by HMAC of numbers that are used once: what answers on the port
 * meanwhile, if it is another program, learns nothing. See `python/palpate/server/resume.py`.
 */
const numberBytes = 32;

export class Resumption {
  private key: string | null = null;

  /** @param address where a page that is let in is given the key. */
  constructor(private readonly address: string) {}

  /** Asks for the key; without it a later engine refuses this page. */
  async learn(): Promise<void> {
    const answer = await fetch(this.address, { cache: "no-store" }).catch(() => null);
    if (answer?.ok === true) {
      this.key = ((await answer.json()) as { readonly key: string }).key;
    }
  }

  /** Whether the engine that is there now is that of this page, and has let it in again. */
  async resume(): Promise<boolean> {
    const { key } = this;
    if (key === null) {
      return false;
    }
    const nonce = hex(crypto.getRandomValues(new Uint8Array(numberBytes)));
    // no cookie goes to what has proven nothing
    const asked = await ask({ nonce }, "omit");
    if (asked?.status !== 200) {
      return false;
    }
    const engine = (await asked.json()) as { readonly nonce: string; readonly proof: string };
    if (engine.proof !== (await proofOf(key, "server", nonce, engine.nonce))) {
      return false;
    }
    const proof = await proofOf(key, "page", nonce, engine.nonce);
    const answer = await ask({ nonce, answers: engine.nonce, proof }, "same-origin");
    return answer?.status === 204;
  }
}

function ask(wanted: object, credentials: RequestCredentials): Promise<Response | null> {
  return fetch("/api/resume", { method: "POST", body: JSON.stringify(wanted), credentials, cache: "no-store" }).catch(
    () => null,
  );
}

/** HMAC-SHA-256 of who says what on which port, as hexadecimal digits. */
async function proofOf(key: string, whose: "server" | "page", ...numbers: readonly string[]): Promise<string> {
  const said = [whose, window.location.port, ...numbers].join(" ");
  const encoder = new TextEncoder();
  const imported = await crypto.subtle.importKey("raw", encoder.encode(key), { name: "HMAC", hash: "SHA-256" }, false, [
    "sign",
  ]);
  return hex(new Uint8Array(await crypto.subtle.sign("HMAC", imported, encoder.encode(said))));
}

function hex(bytes: Uint8Array): string {
  return [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
