/**
 * Whether contact is heard, and how loud; off until a person switches it on.
 */
import { ContactSound, withDrill } from "../../../core/touch/contact_sound";
import type { State } from "../../../core/protocol";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";
import { SoundPlayer } from "./sound_player";

const usual = { on: false, volume: 0.5 };

export class ContactAudio {
  on = $state(usual.on);
  volume = $state(usual.volume);
  /** It is on, but the browser waits for a click or a key before anything is heard. */
  waiting = $state(false);

  private player: SoundPlayer | null = null;
  private sound = new ContactSound();

  constructor(private readonly session: Session) {
    const { on, volume } = recall("sound", usual);
    this.volume = Number.isFinite(volume) ? Math.min(1, Math.max(0, volume)) : usual.volume;
    if (on === true && "AudioContext" in window) {
      this.on = true;
      this.startAtGesture();
    }
  }

  /** How loud it is now, 0..1, for tests and curious people. */
  get level(): number {
    return this.player?.level ?? 0;
  }

  get running(): boolean {
    return this.player?.running ?? false;
  }

  /** Listens to what is felt until the returned function is called. */
  listen(): () => void {
    return this.session.onState((state) => {
      this.hear(state);
    });
  }

  /** Called from a click or a key, else the browser keeps it silent. */
  switch(on: boolean): void {
    if (on && !("AudioContext" in window)) {
      this.session.notify("info", "This browser cannot play sound.");
      return;
    }
    this.on = on;
    this.keep();
    if (on) {
      this.start();
    } else {
      void this.player?.close();
      this.player = null;
      this.waiting = false;
    }
  }

  setVolume(volume: number): void {
    this.volume = volume;
    if (this.player !== null) {
      this.player.volume = volume;
    }
    this.keep();
  }

  private start(): void {
    this.player ??= new SoundPlayer(this.volume);
    this.sound = new ContactSound();
    this.waiting = !this.player.running;
    void this.player.resume().then(() => {
      this.waiting = false;
    });
  }

  private startAtGesture(): void {
    this.waiting = true;
    const aborter = new AbortController();
    const begin = (): void => {
      aborter.abort();
      if (this.on) {
        this.start();
      }
    };
    for (const gesture of ["pointerdown", "keydown"]) {
      window.addEventListener(gesture, begin, { signal: aborter.signal, capture: true });
    }
  }

  private hear(state: State): void {
    if (this.player === null) {
      return;
    }
    const touched = this.session.segments.find((segment) => segment.id === state.touched);
    const stiffness = touched?.feel.stiffness ?? this.session.settings?.stiffness ?? 1;
    this.player.play(withDrill(this.sound.next(state, stiffness), state.tool));
  }

  private keep(): void {
    remember("sound", { on: this.on, volume: this.volume });
  }
}
