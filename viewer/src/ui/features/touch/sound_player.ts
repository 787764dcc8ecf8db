/**
 * Plays contact sounds (Web Audio): bursts and a scrape of filtered noise. Every gain moves
 * along a ramp, so that nothing clicks, and a limiter stands at the end.
 */
import type { Scrape, Sound, Strike } from "../../../core/touch/contact_sound";

/** Every gain needs this long to arrive [s]. */
const ramp = 0.012;
/** Without another word the scrape ends after this time [s]: the states may have stopped. */
const scrapeRest = 0.12;
/** A strike rises this fast [s]: slower than a click, faster than can be told from at once. */
const attack = 0.003;
const noiseSeconds = 2;

export class SoundPlayer {
  private readonly context = new AudioContext({ latencyHint: "interactive" });
  private readonly noise = noiseOf(this.context);
  private readonly master = new GainNode(this.context, { gain: 0 });
  private readonly meter = new AnalyserNode(this.context, { fftSize: 32768 });
  private readonly band = new BiquadFilterNode(this.context, { type: "bandpass", Q: 0.8 });
  private readonly scrapeGain = new GainNode(this.context, { gain: 0 });

  constructor(volume: number) {
    const limiter = new DynamicsCompressorNode(this.context, {
      threshold: -12,
      ratio: 12,
      attack: 0.002,
      release: 0.1,
    });
    this.master.connect(limiter).connect(this.meter).connect(this.context.destination);
    const scrape = new AudioBufferSourceNode(this.context, { buffer: this.noise, loop: true });
    scrape.connect(this.band).connect(this.scrapeGain).connect(this.master);
    scrape.start();
    this.volume = volume;
  }

  /** The browser lets it be heard; without a click or key on the page it does not. */
  get running(): boolean {
    return this.context.state === "running";
  }

  /**
   * Mean square root of what was heard in the last two thirds of a second, 0..1: a page that draws slowly looks seldom.
   */
  get level(): number {
    const samples = new Float32Array(this.meter.fftSize);
    this.meter.getFloatTimeDomainData(samples);
    return Math.sqrt(samples.reduce((sum, sample) => sum + sample * sample, 0) / samples.length);
  }

  set volume(volume: number) {
    this.master.gain.setTargetAtTime(volume, this.context.currentTime, ramp);
  }

  /** Starts it; only works after a click or a key on the page. */
  async resume(): Promise<void> {
    await this.context.resume();
  }

  play({ strike, scrape }: Sound): void {
    if (!this.running) {
      return;
    }
    this.rub(scrape);
    if (strike !== null) {
      this.hit(strike);
    }
  }

  async close(): Promise<void> {
    this.volume = 0;
    await new Promise((resolve) => setTimeout(resolve, 8000 * ramp));
    await this.context.close();
  }

  private rub({ gain, frequency }: Scrape): void {
    const now = this.context.currentTime;
    const level = this.scrapeGain.gain;
    this.band.frequency.setTargetAtTime(frequency, now, ramp);
    level.cancelScheduledValues(now);
    level.setTargetAtTime(gain, now, ramp);
    level.setTargetAtTime(0, now + scrapeRest, ramp);
  }

  private hit({ gain, frequency, seconds }: Strike): void {
    const now = this.context.currentTime;
    const burst = new AudioBufferSourceNode(this.context, { buffer: this.noise });
    const band = new BiquadFilterNode(this.context, { type: "bandpass", frequency, Q: 1.4 });
    const envelope = new GainNode(this.context, { gain: 0 });
    envelope.gain.setValueAtTime(0, now);
    envelope.gain.linearRampToValueAtTime(gain, now + attack);
    // four time constants and a half are a hundredth
    envelope.gain.setTargetAtTime(0, now + attack, seconds / 4.6);
    burst.connect(band).connect(envelope).connect(this.master);
    burst.start(now, Math.random() * (noiseSeconds - 1), 2 * seconds + attack);
  }
}

function noiseOf(context: AudioContext): AudioBuffer {
  const buffer = context.createBuffer(1, noiseSeconds * context.sampleRate, context.sampleRate);
  const samples = buffer.getChannelData(0);
  for (let i = 0; i < samples.length; ++i) {
    samples[i] = 2 * Math.random() - 1;
  }
  return buffer;
}
