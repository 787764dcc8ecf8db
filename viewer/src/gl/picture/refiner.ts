/**
 * Draws the cached picture in pieces that fit into the time of a frame: at once and coarse
 * while the view moves; then, at rest, level by level in strips of rows; last, as the quality
 * says, several shifted pictures averaged for smooth edges. Surfaces are drawn with
 * each of them before its first strip. At rest a GPU goes on as soon as it has drawn a piece; where the CPU draws the
 * next one waits for the next frame, since engine and page need that time. Two eyes have a picture each: while the view
 * moves both are drawn at once, so that they never see different views; at rest one after the other.
 */
import type * as THREE from "three";
import { halton } from "../../core/view/halton";
import { levelsAfter, DrawBudget, type Detail } from "../../core/view/draw_budget";
import type { RestingPicture } from "../../core/view/quality";
import type { FieldFormat } from "../textures/field_texture";
import type { GpuClock } from "../base/gpu_clock";
import type { Tally } from "../surfaces/patch_mesh";
import { PictureTarget } from "../base/picture_target";
import type { RayMarcher, Shift } from "../march/ray_marcher";
import { mostLayers } from "../textures/surface_layers";
import type { Surfaces } from "../surfaces/surfaces";

export interface RefinerOptions {
  readonly software: boolean;
  readonly halfFloat: boolean;
}

/** With what the picture on display was drawn. */
export interface Shown {
  /** Of the resolution; 0 before the first picture. */
  readonly divisor: number;
  /** Per smallest voxel edge. */
  readonly stepsPerVoxel: number;
  /** Pictures that are averaged in it. */
  readonly passes: number;
  /** Of surfaces, in all layers of it. */
  readonly triangles: number;
}

/** Rest before refining starts [ms]: a drag that pauses should not wait for a strip. */
const settleMilliseconds = 90;

/** Layers of the light volume that are worked out at once, at first; then as many as fit into a strip's time. */
const firstLayers = 4;
/** Into so many pieces at most opacity and light are divided each. */
const mostPieces = 6;
/** And while the view moves, where the GPU draws. */
const movingLayers = 8;

/** Steps per voxel edge while the view moves, at the finest: by the light program and by the whole one. */
const movingSteps = { light: 1.5, whole: 1 } as const;

/** First guesses of costs [ms each]. */
const firstCosts = {
  gpu: { waits: 1, samples: 1e-5, triangles: 1e-6 },
  software: { waits: 10, samples: 1e-2, triangles: 2e-4 },
} as const;
/**
 * Time in which few triangles are made, where they are wanted: this much of a picture's, or of the budget where that is
 * more.
 */
const shareOfPreparing = 0.25;
/** Longer it does not take, however long a picture took: a drag would wait [ms]. */
const mostPreparing = 100;
const unshifted: Shift = [0, 0, 0];

export class Refiner {
  /** A picture for each eye. */
  private readonly pictures: PictureTarget[];
  private working: PictureTarget;
  private readonly pace: DrawBudget;
  private resting: RestingPicture = { stepsPerVoxel: 1, passes: 1 };
  private stale = true;
  private drawnAt = 0;
  private levels: number[] = [];
  private row = 0;
  private pass = 0;
  private layers = firstLayers;
  /** Whose picture is drawn at rest. */
  private eye = 0;
  private completing: Promise<void> | null = null;
  /** 1 while what is on display is drawn again, 2 where it will have to be once more. */
  private renewals = 0;
  /** Of surfaces while the view moves. */
  private detail: Detail = "all";
  /** Triangles of the last picture that moved: those in view, and those that were drawn. */
  private seen: Tally = { all: 0, drawn: 0 };
  /** How long that picture took [ms]. */
  private took = 0;
  /** What the picture that is drawn at rest costs, strip by strip. */
  private level = { waits: 0, samples: 0, triangles: 0, milliseconds: 0 };
  /** Triangles of the picture that is drawn at rest. */
  private triangles = 0;
  /** What is on display has changed between two frames. */
  private changed = false;
  /** Whether rays start at random shares of a step. */
  jitter = true;
  shown: Shown = { divisor: 0, stepsPerVoxel: 0, passes: 0, triangles: 0 };
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
    /** Whether pieces may be drawn between two frames now. */
    private readonly mayGoOn: () => boolean,
  ) {
    this.pictures = [new PictureTarget(options.halfFloat)];
    this.working = new PictureTarget(options.halfFloat);
    this.pace = new DrawBudget(0, options.software ? firstCosts.software : firstCosts.gpu);
  }

  /** The picture of an eye; of the first one where there are no more. */
  pictureOf(eye: number): PictureTarget {
    return this.pictures[eye] ?? this.first;
  }

  /** How many pictures there are; to be followed by `resize`. */
  set eyes(count: number) {
    for (const picture of this.pictures.splice(count)) {
      picture.dispose();
    }
    while (this.pictures.length < count) {
      this.pictures.push(new PictureTarget(this.options.halfFloat));
    }
  }

  /** What pictures at rest are drawn with, and the time of a frame [ms]. */
  setQuality(resting: RestingPicture, frameBudget: number): void {
    this.pace.frameBudget = frameBudget;
    if (resting !== this.resting) {
      this.resting = resting;
      this.restart();
    }
  }

  /** The picture is as fine as it gets. */
  get finished(): boolean {
    return (
      !this.stale &&
      !this.changed &&
      this.marcher.isWhole &&
      !this.marcher.light.pending &&
      this.levels.length === 0 &&
      !this.averaging &&
      !this.clock.busy
    );
  }

  resize(width: number, height: number): void {
    for (const picture of [...this.pictures, this.working]) {
      picture.resize(width, height);
    }
    this.restart();
  }

  /** Camera, appearance or scan have changed. */
  restart(): void {
    this.stale = true;
    this.levels = [];
    this.renewals = 0;
  }

  /** Values are finer than before: what is on display stays until it is drawn again, just as fine at least. */
  renew(): void {
    if (this.stale) {
      return;
    }
    if (this.renewals > 0) {
      this.renewals = 2;
      return;
    }
    const { divisor } = this.shown;
    this.renewals = 1;
    this.levels = divisor > 1 ? [divisor, ...levelsAfter(divisor)] : [divisor];
    this.row = 0;
    this.pass = 0;
    this.eye = 0;
  }

  /** Whether the view has changed since it was drawn. */
  get isStale(): boolean {
    return this.stale;
  }

  /** Whether something has changed since this was asked; for what draws in place of this. */
  takeChange(): boolean {
    const changed = this.stale;
    this.stale = false;
    return changed;
  }

  /** Counts pieces from here on: what the GPU has not drawn to the end yet is not counted. */
  recount(): void {
    this.clock.forget();
    this.drawnPieces = 0;
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

  /** Draws the next piece; true where what is on display has changed since the last frame. */
  advance(now: number): boolean {
    const before = this.changed;
    this.changed = false;
    if (this.stale && !this.clock.busy) {
      this.drawMoving(now);
      return true;
    }
    return this.refine(now) || before;
  }

  /** Draws the next piece at rest; true where what is on display has changed. */
  private refine(now: number): boolean {
    if (this.stale || this.clock.busy) {
      return false;
    }
    const settled = now - this.drawnAt >= settleMilliseconds;
    const [level] = this.levels;
    // what is finer is seen at once, by what program there is and in the light before
    if (this.renewals > 0 && settled && level !== undefined) {
      return this.drawLevel(level);
    }
    if (!this.marcher.isWhole) {
      this.completing ??= this.complete();
      return false;
    }
    if (!settled) {
      return false;
    }
    this.chooseDetail();
    if (this.marcher.light.pending) {
      this.workOutLight();
      return false;
    }
    if (level !== undefined) {
      return this.drawLevel(level);
    }
    return this.averaging && this.drawAverage();
  }

  dispose(): void {
    this.clock.forget();
    for (const picture of [...this.pictures, this.working]) {
      picture.dispose();
    }
  }

  private async onPixel(work: (pixel: PictureTarget) => Promise<void>): Promise<void> {
    const pixel = new PictureTarget(this.options.halfFloat);
    await work(pixel);
    pixel.dispose();
  }

  private get first(): PictureTarget {
    return this.pictures[0] ?? this.working;
  }

  /** Of a ray while the view moves, at the finest. */
  private get movingSteps(): number {
    return this.marcher.isWhole ? movingSteps.whole : movingSteps.light;
  }

  /** Of all eyes' pictures while the view moves, at the finest. */
  private get movingSamples(): number {
    return this.pictures.length * this.pixels * this.movingSteps;
  }

  /** Translucent layers while the view moves: each costs all triangles once, however coarse the picture. */
  private get movingLayers(): number {
    return this.options.software ? 2 : mostLayers;
  }

  /** Without half floats an average would be one of rounded bytes. */
  private get averaging(): boolean {
    return this.jitter && this.options.halfFloat && this.pass < this.resting.passes;
  }

  /** Of a whole picture. */
  private get pixels(): number {
    const { width, height } = this.first.target;
    return width * height;
  }

  /** What is drawn at rest waits for its light: pictures that move show the light before. */
  private workOutLight(): void {
    const { light } = this.marcher;
    // however busy the machine is, pieces are not so small that frames between them are all of the time
    const layers = Math.max(this.layers, Math.ceil(light.counts[2] / mostPieces));
    light.advance(this.renderer, layers);
    this.clock.start((milliseconds) => {
      const fitting = (layers * this.pace.frameBudget) / Math.max(milliseconds, 1);
      this.layers = Math.max(1, Math.min(2 * layers, Math.round(fitting)));
      this.goOn();
    });
  }

  private drawMoving(now: number): void {
    // its program is not one of those that the first picture waits for
    if (!this.options.software && this.marcher.isWhole && this.marcher.light.pending) {
      this.marcher.light.advance(this.renderer, movingLayers);
    }
    this.chooseDetail();
    const begun = performance.now();
    const eyes = this.pictures.length;
    const { divisor, step } = this.pace.picture(
      this.movingSamples,
      this.detail === "all" ? this.seen.all : this.seen.drawn,
    );
    const stepsPerVoxel = step * this.movingSteps;
    const seen = { all: 0, drawn: 0 };
    for (let eye = 0; eye < eyes; ++eye) {
      this.aim(eye);
      this.working.useLevel(divisor);
      const surfaces = { divisor, stepsPerVoxel, shift: unshifted, depth: this.movingLayers, detail: this.detail };
      const { all, drawn } = this.surfaces.draw(this.renderer, this.working, surfaces);
      seen.all += all;
      seen.drawn += drawn;
      this.drawRows(this.working, [0, this.working.height], stepsPerVoxel, unshifted);
      this.swap(eye);
    }
    this.seen = seen;
    const samples = eyes * this.first.width * this.first.height * stepsPerVoxel;
    this.time(() => {
      this.took = performance.now() - begun;
      this.pace.learnMoving({ waits: 1, samples, triangles: seen.drawn }, this.took);
    });
    this.shown = { divisor, stepsPerVoxel, passes: 1, triangles: seen.drawn };
    this.stale = false;
    this.drawnAt = now;
    this.levels = levelsAfter(divisor);
    this.row = 0;
    this.pass = 0;
    this.eye = 0;
  }

  /**
   * Chooses how much of surfaces is drawn while the view moves, and makes some of the few triangles where they are
   * wanted.
   */
  private chooseDetail(): void {
    this.detail = this.pace.detail(this.movingSamples, this.seen.all);
    if (this.detail === "few") {
      this.surfaces.prepareFew(Math.min(mostPreparing, shareOfPreparing * Math.max(this.pace.frameBudget, this.took)));
    }
  }

  /** Draws a strip of a finer picture, which replaces the one on display once it is whole. */
  private drawLevel(divisor: number): boolean {
    this.working.useLevel(divisor);
    if (!this.drawStrip(this.working, divisor, unshifted)) {
      return false;
    }
    this.swap(this.eye);
    if (this.nextEye()) {
      this.shown = { divisor, stepsPerVoxel: this.resting.stepsPerVoxel, passes: 1, triangles: this.triangles };
      this.levels.shift();
      this.pass = 1;
      this.endRenewal();
    }
    return true;
  }

  /** What has become finer meanwhile is drawn too. */
  private endRenewal(): void {
    const again = this.renewals > 1;
    this.renewals = 0;
    if (again) {
      this.renew();
    }
  }

  /** Blends a strip of one more picture, shifted within the pixel, into the one on display. */
  private drawAverage(): boolean {
    const count = this.pass + 1;
    // covers the pixel evenly
    const shift: Shift = [halton(count, 2) - 0.5, halton(count, 3) - 0.5, count];
    this.marcher.blend = 1 / count;
    const whole = this.drawStrip(this.pictureOf(this.eye), 1, shift);
    this.marcher.blend = null;
    if (whole && this.nextEye()) {
      this.pass = count;
      this.shown = { ...this.shown, passes: count };
    }
    return whole;
  }

  /** Draws the next rows that fit into a frame; true where they were the last. */
  private drawStrip(target: PictureTarget, divisor: number, shift: Shift): boolean {
    const { stepsPerVoxel } = this.resting;
    this.turn();
    const { width, height } = target;
    if (this.row === 0) {
      const triangles = this.drawSurfaces(target, divisor, shift);
      this.level = { waits: 0, samples: width * height * stepsPerVoxel, triangles, milliseconds: 0 };
    }
    const to = Math.min(height, this.row + this.pace.stripRows(width, height, stepsPerVoxel));
    this.drawRows(target, [this.row, to], stepsPerVoxel, shift);
    const { level } = this;
    const whole = to === height;
    this.time((milliseconds) => {
      level.waits += 1;
      level.milliseconds += milliseconds;
      if (whole) {
        this.pace.learnResting(level, level.milliseconds);
      }
    });
    this.row = whole ? 0 : to;
    return whole;
  }

  /** Draws all of the surfaces for a picture at rest; returns their triangles. */
  private drawSurfaces(target: PictureTarget, divisor: number, shift: Shift): number {
    const { stepsPerVoxel } = this.resting;
    const { drawn } = this.surfaces.draw(this.renderer, target, {
      divisor,
      stepsPerVoxel,
      shift,
      depth: mostLayers,
      detail: "all",
    });
    this.triangles = this.eye === 0 ? drawn : this.triangles + drawn;
    return drawn;
  }

  private drawRows(target: PictureTarget, rows: readonly [number, number], stepsPerVoxel: number, shift: Shift): void {
    target.useRows(...rows);
    this.marcher.draw(this.renderer, target, { stepsPerVoxel, jitter: this.jitter }, shift);
  }

  /** Counts a piece, and tells what it cost, once the GPU has drawn it. */
  private time(done: (milliseconds: number) => void): void {
    this.clock.start((milliseconds) => {
      done(milliseconds);
      this.drawnPieces += 1;
      this.goOn();
    });
  }

  /** Draws the next piece at rest without waiting for a frame, where a GPU draws. */
  private goOn(): void {
    if (!this.options.software && this.mayGoOn()) {
      this.changed = this.refine(performance.now()) || this.changed;
    }
  }

  /** Turns to the eye whose picture is drawn; a single one stays where the view left it. */
  private turn(): void {
    if (this.pictures.length > 1) {
      this.aim(this.eye);
    }
  }

  /** Goes on to the next eye; true where all had their turn. */
  private nextEye(): boolean {
    this.eye = (this.eye + 1) % this.pictures.length;
    return this.eye === 0;
  }

  private swap(eye: number): void {
    const drawn = this.working;
    this.working = this.pictureOf(eye);
    this.pictures[eye] = drawn;
  }
}
