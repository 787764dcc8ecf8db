/**
 * Plays what a tool did and felt in a scenario: the tool stands in the picture where it stood then.
 * Touch takes over again as soon as the hand moves.
 */
import {
  endOf,
  forceBefore,
  holderOf,
  momentAt,
  parseRun,
  RunError,
  type Moment,
  type ScenarioRun,
} from "../../../core/scenario/scenario_run";
import { addScaled } from "../../../core/geometry/vector";
import { apiAddress } from "../../../live/connection";
import type { PlayedTouch } from "../../../core/touch/shown_touch";
import type { Session } from "../../state/session.svelte";

/** How fast a run is played, as a share of its own time. */
export const speeds: readonly number[] = [0.25, 1, 4, 16];

/** In which a run's curve is drawn. */
export const phaseColours = { in: "--accent", rest: "--muted", out: "--warning" } as const;

/** How far behind the tip a needle is held [mm]. */
const needleLength = 60;
/** A force below this is none [N]. */
const leastForce = 1e-3;

export class Player {
  run = $state.raw<ScenarioRun | null>(null);
  time = $state.raw(0);
  playing = $state.raw(false);
  speed = $state.raw(1);
  /** The run's tool is shown, and not the probe. */
  showing = $state.raw(false);

  private last = 0;

  constructor(private readonly session: Session) {}

  readonly moment = $derived.by((): Moment | null => (this.run === null ? null : momentAt(this.run, this.time)));

  /** The tool as picture and slices show it in place of the probe; null while the probe is shown. */
  readonly shown = $derived.by((): PlayedTouch | null => {
    const { run, moment } = this;
    if (run === null || moment === null || !this.showing) {
      return null;
    }
    const back = addScaled([0, 0, 0], moment.way, -1);
    return {
      time: moment.time,
      proxy: moment.tool,
      device: run.radius === 0 ? holderOf(moment, needleLength) : moment.tool,
      probe_radius: run.radius,
      contact: Math.abs(moment.magnitude) > leastForce,
      contact_point: addScaled(moment.tool, moment.way, run.radius),
      normal: back,
      force: moment.force,
      words: `${run.scenario}: ${moment.layer === "" ? "outside" : `in ${moment.layer}`}`,
      series: (seconds) => forceBefore(run, moment.time, seconds),
    };
  });

  /** Asks the engine for the run that it was started with, if there is one. */
  async fetch(): Promise<void> {
    const answer = await fetch(apiAddress("/api/scenario"));
    if (answer.status === 200) {
      this.open(await answer.text(), "the run");
    }
  }

  /** Takes a file that a person has chosen. */
  async choose(file: File): Promise<void> {
    this.open(await file.text(), file.name);
  }

  close(): void {
    this.release();
    this.run = null;
  }

  play(): void {
    const { run } = this;
    if (run === null) {
      return;
    }
    if (this.time >= endOf(run)) {
      this.time = 0;
    }
    this.showing = true;
    this.playing = true;
    this.last = performance.now();
    requestAnimationFrame(this.advance);
  }

  pause(): void {
    this.playing = false;
  }

  seek(time: number): void {
    const { run } = this;
    if (run !== null) {
      this.time = Math.min(Math.max(time, 0), endOf(run));
      this.showing = true;
    }
  }

  /** Shows the probe again. */
  release(): void {
    this.pause();
    this.showing = false;
  }

  private open(text: string, name: string): void {
    try {
      this.run = parseRun(text);
    } catch (error) {
      if (!(error instanceof RunError)) {
        throw error;
      }
      this.session.notify("error", `${name} cannot be played: ${error.message}`);
      return;
    }
    const { scan } = this.session;
    if (scan !== null && scan.name !== this.run.scan) {
      this.session.notify("warning", `This run is of ${this.run.scan}, and the scan that is open is ${scan.name}.`);
    }
    this.pause();
    this.seek(0);
  }

  private readonly advance = (now: number): void => {
    const { run } = this;
    if (run === null || !this.playing) {
      return;
    }
    this.seek(this.time + (this.speed * (now - this.last)) / 1000);
    this.last = now;
    if (this.time >= endOf(run)) {
      this.pause();
    } else {
      requestAnimationFrame(this.advance);
    }
  };
}
