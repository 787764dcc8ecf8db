/** Has an open scan read again in its place, and asks first where changes of it would be lost. */
import type { Wanted, Library } from "./library.svelte";

export class Rereader {
  /** It is asked whether changes that are kept nowhere may go. */
  doubted = $state.raw<Wanted | null>(null);
  /** What was asked for here is under way, or has failed. */
  private asked = $state.raw(false);

  constructor(
    private readonly library: Library,
    private readonly beside: boolean,
  ) {}

  get work(): Library["work"] {
    return this.asked ? this.library.work : null;
  }

  get failure(): string | null {
    return this.asked && this.work === null ? this.library.failure : null;
  }

  async ask(wanted: Wanted): Promise<void> {
    await this.library.look();
    const about = this.library.about ?? null;
    if (!this.beside && about !== null && about.changed && !about.kept) {
      this.doubted = wanted;
    } else {
      await this.read(wanted);
    }
  }

  async read(wanted: Wanted): Promise<void> {
    this.doubted = null;
    this.asked = true;
    await this.library.reread(wanted, { beside: this.beside });
    this.asked = this.library.failure !== null;
  }
}
