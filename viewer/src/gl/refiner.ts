/**
 * Draws the cached picture in pieces that fit into the time there is: at once and coarse
 * while the view moves; then, at rest, level by level in strips of rows; last, where the
 * GPU is quick, several shifted pictures averaged for smooth edges. Surfaces are drawn with
 * each level before its first strip. Two eyes have a picture each: while the view moves both are drawn
 * at once, so that they never see different views; at rest one after the other.
 */
import type * as THREE from "three";
import { halton } from "../core/halton";
import { levelsAfter, Pace } from "../core/pace";
import type { FieldFormat } from "./field_texture";
import type { GpuClock } from "./gpu_clock";
import { PictureTarget } from "./picture_target";
import type { RayMarcher, Shift } from "./ray_marcher";
import { mostLayers } from "./surface_layers";
import type { Surfaces } from "./surfaces";

export interface RefinerOptions {
  readonly software: boolean;
  readonly halfFloat: boolean;
}

/** Rest before refining starts [ms]: a drag that pauses should not wait for a strip. */
const settleMilliseconds = 90;

/** Time of a whole picture up to which several are averaged at rest [ms]. */
const quickPicture = 60;
const averaged = 8;

/** Layers of the light volume that are worked out at once, at first; then as many as fit into a strip's time. */
const firstLayers = 4;
/** Into so many pieces at most opacity and light are divided each. */
const mostPieces = 6;
/** And while the view moves, where the GPU draws. */
const movingLayers = 8;

/** Steps per voxel edge while the view moves and at rest; fewer where the CPU draws. By the light program they are cheap. */
const steps = { gpu: { light: 1.5, moving: 1, resting: 1.5 }, software: { light: 1.5, moving: 0.75, resting: 1 } } as const;

export class Refiner {
  /** A picture for each eye. */
  private readonly shown: PictureTarget[];
  private working: PictureTarget;
  private readonly pace: Pace;
  /** Time for a piece at rest [ms]. */
  private readonly stripBudget: number;
  private stale = true;
  private drawnAt = 0;
  private levels: number[] = [];
  private row = 0;
  private pass = 0;
  private layers = firstLayers;
  /** Whose picture is drawn at rest. */
  private eye = 0;
  private completing: Promise<void> | null = null;
  /** Whether rays start at random shares of a step. */
  jitter = true;
  /** Divisor of the resolution on display; 0 before the first picture. */
  shownDivisor = 0;
  /** Pieces that the GPU has drawn to the end. */
  drawnPieces = 0;

  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly clock: GpuClock,
    private readonly marcher: RayMarcher,
    private readonly surfaces: Surfaces,
    private readonly options: RefinerOptions,
    /** Turns ray caster and surfaces to what an eye sees now. */
    private readonly aim: (eye: number) => void,
  ) {
    this.shown = [new PictureTarget(options.halfFloat)];
    this.working = new PictureTarget(options.halfFloat);
    this.stripBudget = options.software ? 40 : 24;
    this.pace = new Pace({
      frameBudget: options.software ? 70 : 24,
      stripBudget: this.stripBudget,
      pixelCost: options.software ? 5e-3 : 1e-5,
    });
  }

  /** The picture of an eye; of the first one where there are no more. */
  pictureOf(eye: number): PictureTarget {
    return this.shown[eye] ?? this.first;
  }

  /** How many pictures there are; to be followed by `resize`. */
  set eyes(count: number) {
    for (const picture of this.shown.splice(count)) {
      picture.dispose();
    }
    while (this.shown.length < count) {
      this.shown.push(new PictureTarget(this.options.halfFloat));
    }
  }

  /** The picture is as fine as it gets. */
  get finished(): boolean {
    return !this.stale && this.marcher.isWhole && !this.marcher.light.pending && this.levels.length === 0 && !this.averaging && !this.clock.busy;
  }

  resize(width: number, height: number): void {
    for (const picture of [...this.shown, this.working]) {
      picture.resize(width, height);
    }
    this.restart();
  }

  /** Camera, look or scan have changed. */
  restart(): void {
    this.stale = true;
    this.levels = [];
  }

  /** Has the GPU ready what the first picture will be drawn with. */
  async prepare(format: FieldFormat): Promise<void> {
    await this.onPixel(async (pixel) => {
      await this.marcher.prepare(this.renderer, pixel, format);
    });
  }

  /** Has the GPU ready what all others are drawn with. */
  async complete(): Promise<void> {
    await this.onPixel(async (pixel) => {
      await this.marcher.complete(this.renderer, pixel);
    });
  }

  /** Draws the next piece; true where what is on display has changed. */
  advance(now: number): boolean {
    if (this.clock.busy) {
      return false;
    }
    if (this.stale) {
      this.drawMoving(now);
      return true;
    }
    if (!this.marcher.isWhole) {
      this.completing ??= this.complete();
      return false;
    }
    if (now - this.drawnAt < settleMilliseconds) {
      return false;
    }
    if (this.marcher.light.pending) {
      this.workOutLight();
      return false;
    }
    if (this.levels.length > 0) {
      return this.drawStrip();
    }
    return this.averaging && this.drawAverage();
  }

  dispose(): void {
    this.clock.forget();
    for (const picture of [...this.shown, this.working]) {
      picture.dispose();
    }
  }

  private async onPixel(work: (pixel: PictureTarget) => Promise<void>): Promise<void> {
    const pixel = new PictureTarget(this.options.halfFloat);
    await work(pixel);
    pixel.dispose();
  }

  private get first(): PictureTarget {
    return this.shown[0] ?? this.working;
  }

  private get steps(): { readonly moving: number; readonly resting: number } {
    const { light, moving, resting } = this.options.software ? steps.software : steps.gpu;
    return { moving: this.marcher.isWhole ? moving : light, resting };
  }

  /** Translucent layers while the view moves: each costs all triangles once, however coarse the picture. */
  private get movingLayers(): number {
    return this.options.software ? 2 : mostLayers;
  }

  private get averaging(): boolean {
    return (
      this.jitter &&
      this.pass < averaged &&
      this.options.halfFloat &&
      this.pace.expected(this.pixels(1)) < quickPicture
    );
  }

  private pixels(divisor: number): number {
    const { width, height } = this.first.target;
    return (width * height) / divisor ** 2;
  }

  /** What is drawn at rest waits for its light: pictures that move show the light before. */
  private workOutLight(): void {
    const { light } = this.marcher;
    // however busy the machine is, pieces are not so small that frames between them are all of the time
    const layers = Math.max(this.layers, Math.ceil(light.counts[2] / mostPieces));
    light.advance(this.renderer, layers);
    this.clock.start((milliseconds) => {
      const fitting = (layers * this.stripBudget) / Math.max(milliseconds, 1);
      this.layers = Math.max(1, Math.min(2 * layers, Math.round(fitting)));
    });
  }

  private drawMoving(now: number): void {
    if (!this.options.software && this.marcher.light.pending) {
      this.marcher.light.advance(this.renderer, movingLayers);
    }
    const eyes = this.shown.length;
    const divisor = this.pace.movingDivisor(eyes * this.pixels(1));
    for (let eye = 0; eye < eyes; ++eye) {
      this.aim(eye);
      this.working.useLevel(divisor);
      this.surfaces.draw(this.renderer, this.working, { divisor, shift: [0, 0, 0], depth: this.movingLayers });
      this.drawRows(0, this.working.height, this.steps.moving, [0, 0, 0]);
      this.swap(eye);
    }
    this.learn(eyes * this.first.width * this.first.height);
    this.shownDivisor = divisor;
    this.stale = false;
    this.drawnAt = now;
    this.levels = levelsAfter(divisor);
    this.row = 0;
    this.pass = 0;
    this.eye = 0;
  }

  private drawStrip(): boolean {
    const level = this.levels[0] ?? 1;
    this.turn();
    this.working.useLevel(level);
    if (this.row === 0) {
      this.surfaces.draw(this.renderer, this.working, { divisor: level, shift: [0, 0, 0], depth: mostLayers });
    }
    const { width, height } = this.working;
    const to = Math.min(height, this.row + this.pace.stripRows(width, height));
    this.drawRows(this.row, to, this.steps.resting, [0, 0, 0]);
    this.learn(width * (to - this.row));
    this.row = to;
    if (to < height) {
      return false;
    }
    this.swap(this.eye);
    this.row = 0;
    if (this.nextEye()) {
      this.shownDivisor = level;
      this.levels.shift();
      this.pass = 1;
    }
    return true;
  }

  /** Blends one more picture, shifted within the pixel, into the one on display. */
  private drawAverage(): boolean {
    const count = this.pass + 1;
    // covers the pixel evenly
    const shift: Shift = [halton(count, 2) - 0.5, halton(count, 3) - 0.5, count];
    const shown = this.pictureOf(this.eye);
    const { working } = this;
    this.turn();
    this.working = shown;
    this.surfaces.draw(this.renderer, this.working, { divisor: 1, shift, depth: mostLayers });
    this.marcher.blend = 1 / count;
    this.drawRows(0, shown.height, this.steps.resting, shift);
    this.marcher.blend = null;
    this.working = working;
    this.learn(shown.width * shown.height);
    if (this.nextEye()) {
      this.pass = count;
    }
    return true;
  }

  private drawRows(from: number, to: number, stepsPerVoxel: number, shift: Shift): void {
    this.working.useRows(from, to);
    this.marcher.draw(this.renderer, this.working, { stepsPerVoxel, jitter: this.jitter }, shift);
  }

  /** Learns what the pixels cost that were just drawn. */
  private learn(pixels: number): void {
    this.clock.start((milliseconds) => {
      this.pace.learn(pixels, milliseconds);
      this.drawnPieces += 1;
    });
  }

  /** Turns to the eye whose picture is drawn; a single one stays where the view left it. */
  private turn(): void {
    if (this.shown.length > 1) {
      this.aim(this.eye);
    }
  }

  /** Goes on to the next eye; true where all had their turn. */
  private nextEye(): boolean {
    this.eye = (this.eye + 1) % this.shown.length;
    return this.eye === 0;
  }

  private swap(eye: number): void {
    const drawn = this.working;
    this.working = this.pictureOf(eye);
    this.shown[eye] = drawn;
  }
}
