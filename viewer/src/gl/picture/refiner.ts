/**
 * Draws the cached picture: at once while the view moves; then, at rest, level by level, each in pieces that are seen
 * as they come, from the middle out; last, as the quality says, several shifted pictures averaged for smooth edges.
 * Where only a part of the view has changed, that part is drawn first, and nothing becomes coarser. Surfaces are drawn
 * with each picture before its first piece. At rest the next piece follows as soon as one is drawn; where the CPU
 * draws, those that are to be seen come to the screen first. Two eyes have a picture each: while the view moves both
 * are drawn at once, so that they never see different views; at rest one after the other.
 */
import type * as THREE from "three";
import { halton } from "../../core/view/halton";
import { levelsAfter, DrawBudget, type Detail, type Level } from "../../core/view/draw_budget";
import { MiddleOut } from "../../core/view/middle_out";
import type { RestingPicture } from "../../core/view/quality";
import { joined, texelsOf, type Region } from "../../core/view/region";
import type { FieldFormat } from "../textures/field_texture";
import type { GpuClock } from "../base/gpu_clock";
import type { Tally } from "../surfaces/patch_mesh";
import { PictureTarget } from "../base/picture_target";
import type { RayMarcher, Shift } from "../march/ray_marcher";
import { mostLayers } from "../textures/surface_layers";
import type { Surfaces } from "../surfaces/surfaces";
import { Stretcher } from "./stretcher";

export interface RefinerOptions {
  readonly software: boolean;
  readonly halfFloat: boolean;
}

/** What the picture is drawn for. */
export interface RefinerHost {
  /** Turns ray caster and surfaces to what an eye sees now. */
  readonly aim: (eye: number) => void;
  /** What they were turned to last is on display from now on. */
  readonly present: () => void;
  /** Whether pieces may be drawn between two frames now. */
  readonly mayGoOn: () => boolean;
  /** Whether all that is awaited for the first pictures has come. */
  readonly isLoaded: () => boolean;
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

/** The pictures of an eye: on display, and another to draw the next one into. */
interface EyePictures {
  shown: PictureTarget;
  next: PictureTarget;
}

/** A picture or a part of it that is drawn at rest, piece by piece. */
interface Work {
  readonly target: PictureTarget;
  readonly stepsPerVoxel: number;
  readonly shift: Shift;
  readonly rows: MiddleOut;
  /** The first, and the one after the last. */
  readonly columns: readonly [number, number];
}

/** Rest before refining starts [ms]: a drag that pauses should not wait for a piece. */
const settleMilliseconds = 90;
/** Without an edit before light is worked out again [ms]: while one drills it would come too late. */
const settleOfEdits = 400;
/** Between two looks at a picture whose pieces come one by one [ms]: each costs time on the screen. */
const pauseOfPieces = 600;

/** Layers of the light volume that are worked out at once, at first; then as many as fit into a piece's time. */
const firstLayers = 4;
/** Into so many pieces at most opacity and light are divided each. */
const mostPieces = 12;
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
  private eyePictures: [EyePictures, ...EyePictures[]];
  private readonly stretcher = new Stretcher();
  private readonly pace: DrawBudget;
  private resting: RestingPicture = { stepsPerVoxel: 1, passes: 1 };
  private stale = true;
  /** When the view, or all that is seen, has changed last, and when a part of it has [ms]. */
  private movedAt = 0;
  private editedAt = 0;
  /** What is still to be drawn at rest. */
  private levels: Level[] = [];
  private work: Work | null = null;
  private pass = 0;
  private layers = firstLayers;
  /** Whose picture is drawn at rest. */
  private eye = 0;
  private completing: Promise<void> | null = null;
  /** What the picture shows has changed since the level at work was begun. */
  private again = false;
  /** The part of the view that has changed and is still to be drawn, and the one that is drawn. */
  private region: Region | null = null;
  private patch: Work | null = null;
  /** Parts that have changed were drawn last: the whole is to have its turn. */
  private hasPatched = false;
  /** Of surfaces while the view moves. */
  private detail: Detail = "all";
  /** Triangles of the last picture that moved: those in view, and those that were drawn. */
  private seen: Tally = { all: 0, drawn: 0 };
  /** How long that picture took [ms]. */
  private took = 0;
  /** Triangles of the picture that is drawn at rest. */
  private triangles = 0;
  /** What is on display has changed since the last frame. */
  private changed = false;
  private changedAt = 0;
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
    private readonly host: RefinerHost,
  ) {
    this.eyePictures = [this.newPictures()];
    this.pace = new DrawBudget(0, options.software ? firstCosts.software : firstCosts.gpu);
  }

  /** The picture of an eye; of the first one where there are no more. */
  pictureOf(eye: number): PictureTarget {
    return this.picturesOf(eye).shown;
  }

  /** How many pictures there are; to be followed by `resize`. */
  set eyes(count: number) {
    for (const { shown, next } of this.eyePictures.splice(count)) {
      shown.dispose();
      next.dispose();
    }
    while (this.eyePictures.length < count) {
      this.eyePictures.push(this.newPictures());
    }
  }

  /** What pictures at rest are drawn with, and the time of one while the view moves [ms]. */
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
      this.completing === null &&
      !this.marcher.light.pending &&
      this.levels.length === 0 &&
      this.region === null &&
      this.patch === null &&
      !this.averaging &&
      !this.clock.busy
    );
  }

  resize(width: number, height: number): void {
    for (const { shown, next } of this.eyePictures) {
      shown.resize(width, height);
      next.resize(width, height);
    }
    this.restart();
  }

  /** Camera, appearance or scan have changed. */
  restart(): void {
    this.stale = true;
    this.movedAt = performance.now();
    this.levels = [];
    this.again = false;
    this.work = null;
    this.region = null;
    this.patch = null;
    this.eye = 0;
  }

  /** Values are finer than before, or lit in another way: what is on display becomes so piece by piece. */
  renew(): void {
    if (this.stale) {
      return;
    }
    if (this.work === null) {
      this.levels = levelsAfter(this.shown.divisor);
      this.pass = 0;
    } else {
      this.again = true;
    }
  }

  /** Only a part of a single eye's view has changed: it is drawn first, all else stays as fine as it is. */
  change(region: Region): void {
    if (this.stale || this.eyePictures.length > 1) {
      this.restart();
      return;
    }
    this.region = this.region === null ? region : joined(this.region, region);
    this.editedAt = performance.now();
    this.renew();
  }

  /** Whether the view has changed since it was drawn. */
  get isStale(): boolean {
    return this.stale;
  }

  /** There is a picture that is on display with the next frame. */
  get awaitsFrame(): boolean {
    return this.changed;
  }

  /** Counts pieces from here on: what the GPU has not drawn to the end yet is not counted. */
  recount(): void {
    this.clock.forget();
    this.drawnPieces = 0;
  }

  /** Has the GPU ready what the first picture will be drawn with. */
  async prepare(format: FieldFormat): Promise<void> {
    await Promise.all([
      this.stretcher.prepare(this.renderer),
      this.onPixel(async (pixel) => {
        await this.marcher.prepare(this.renderer, pixel, format);
      }),
    ]);
  }

  /** Has the GPU ready what all others are drawn with. */
  async complete(): Promise<void> {
    await this.onPixel(async (pixel) => {
      await this.marcher.complete(this.renderer, pixel);
    });
  }

  /**
   * Draws the next piece; true where what is on display has changed since the last frame. Where the CPU draws, what is
   * on the screen is read back at the end of the frame: a piece begun before would be waited for.
   */
  advance(now: number): boolean {
    const { changed } = this;
    this.changed = false;
    if (this.options.software && changed) {
      setTimeout(() => {
        this.goOn();
      });
      return true;
    }
    this.drawNext(now);
    const moved = this.changed;
    this.changed = false;
    return changed || moved;
  }

  dispose(): void {
    this.clock.forget();
    this.stretcher.dispose();
    for (const { shown, next } of this.eyePictures) {
      shown.dispose();
      next.dispose();
    }
  }

  private async onPixel(work: (pixel: PictureTarget) => Promise<void>): Promise<void> {
    const pixel = new PictureTarget(this.options.halfFloat);
    await work(pixel);
    pixel.dispose();
  }

  private get first(): PictureTarget {
    return this.eyePictures[0].shown;
  }

  /** Of a ray while the view moves, at the finest. */
  private get movingSteps(): number {
    return this.marcher.isWhole ? movingSteps.whole : movingSteps.light;
  }

  /** Of all eyes' pictures while the view moves, at the finest. */
  private get movingSamples(): number {
    return this.eyePictures.length * this.pixels * this.movingSteps;
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

  private newPictures(): EyePictures {
    return { shown: new PictureTarget(this.options.halfFloat), next: new PictureTarget(this.options.halfFloat) };
  }

  private picturesOf(eye: number): EyePictures {
    return this.eyePictures[eye] ?? this.eyePictures[0];
  }

  private drawNext(now: number): void {
    if (this.clock.busy) {
      return;
    }
    if (this.stale) {
      this.drawMoving();
    } else {
      this.refine(now);
    }
  }

  /** Draws the next piece at rest. */
  private refine(now: number): void {
    if ((this.patch !== null || this.region !== null) && !this.hasPatched) {
      this.drawPatch();
      return;
    }
    this.hasPatched = false;
    if (now - this.movedAt < settleMilliseconds) {
      return;
    }
    this.chooseDetail();
    const [level] = this.levels;
    if (level !== undefined && level.divisor > 1) {
      this.drawLevel(level);
    } else if (this.marcher.light.pending && this.marcher.isWhole) {
      if (now - this.editedAt >= settleOfEdits) {
        this.workOutLight();
      }
    } else {
      this.completeOnce();
      if (level !== undefined) {
        this.drawLevel(level);
      } else if (this.averaging) {
        this.drawAverage();
      }
    }
  }

  /** Has the whole program made, once there is a picture that bears to be looked at meanwhile. */
  private completeOnce(): void {
    if (!this.marcher.isWhole && this.completing === null && this.host.isLoaded()) {
      this.completing = this.complete().then(() => {
        this.completing = null;
        // what the light program has begun is not finished by it
        this.work = null;
        this.renew();
      });
    }
  }

  /** Only the last picture waits for its light: until then the light before is seen. */
  private workOutLight(): void {
    const { light } = this.marcher;
    // however busy the machine is, pieces are not so small that frames between them are all of the time
    const layers = Math.max(this.layers, Math.ceil(light.counts[2] / mostPieces));
    light.advance(this.renderer, layers);
    this.clock.start((milliseconds) => {
      const fitting = (layers * this.pace.pieceBudget) / Math.max(milliseconds, 1);
      this.layers = Math.max(1, Math.min(2 * layers, Math.round(fitting)));
      if (!light.pending) {
        this.renew();
      }
      this.goOnAtOnce();
    });
  }

  private drawMoving(): void {
    // its program is not one of those that the first picture waits for
    if (!this.options.software && this.marcher.isWhole && this.marcher.light.pending) {
      this.marcher.light.advance(this.renderer, movingLayers);
    }
    this.chooseDetail();
    const begun = performance.now();
    const { divisor, step } = this.pace.picture(
      this.movingSamples,
      this.detail === "all" ? this.seen.all : this.seen.drawn,
    );
    const stepsPerVoxel = step * this.movingSteps;
    const seen = { all: 0, drawn: 0 };
    let samples = 0;
    this.eyePictures.forEach(({ next }, eye) => {
      this.host.aim(eye);
      next.useLevel(divisor);
      const surfaces = { divisor, stepsPerVoxel, shift: unshifted, depth: this.movingLayers, detail: this.detail };
      const { all, drawn } = this.surfaces.draw(this.renderer, next, surfaces);
      seen.all += all;
      seen.drawn += drawn;
      next.useRows(0, next.height);
      this.march(next, stepsPerVoxel, unshifted);
      samples += next.width * next.height * stepsPerVoxel;
    });
    this.seen = seen;
    this.stale = false;
    this.levels = levelsAfter(divisor);
    this.pass = 0;
    const put = (): void => {
      this.eyePictures.forEach((_, eye) => { this.swap(eye); });
      this.shown = { divisor, stepsPerVoxel, passes: 1, triangles: seen.drawn };
      this.host.present();
      this.show();
    };
    if (!this.options.software) {
      put();
    }
    this.time(() => {
      this.took = performance.now() - begun;
      this.pace.learnMoving({ waits: 1, samples, triangles: seen.drawn }, this.took);
      if (this.options.software) {
        put();
      }
    });
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

  /** Draws a piece of the part that has changed over what is on display. */
  private drawPatch(): void {
    if (this.patch === null && this.region !== null) {
      const target = this.first;
      const { rows, columns } = texelsOf(this.region, target.width, target.height);
      this.region = null;
      const { stepsPerVoxel } = this.shown;
      this.patch = { target, stepsPerVoxel, shift: unshifted, rows: new MiddleOut(rows), columns };
    }
    const { patch } = this;
    if (patch !== null) {
      this.hasPatched = true;
      this.drawPiece(patch, () => { this.show(); });
      this.patch = patch.rows.done ? null : patch;
    }
  }

  /** Draws a piece of a finer picture over what is on display. */
  private drawLevel({ divisor, step }: Level): void {
    const stepsPerVoxel = divisor > 1 ? step * this.movingSteps : this.resting.stepsPerVoxel;
    const work = (this.work ??= this.begin(divisor, stepsPerVoxel, unshifted));
    this.drawPiece(work, (whole) => {
      if (whole || performance.now() - this.changedAt >= pauseOfPieces) {
        this.show();
      }
    });
    if (!work.rows.done) {
      return;
    }
    this.work = null;
    if (this.nextEye()) {
      this.shown = { divisor, stepsPerVoxel, passes: 1, triangles: this.triangles };
      this.levels.shift();
      this.pass = 1;
      this.endLevel();
    }
  }

  /** What has changed meanwhile is drawn too. */
  private endLevel(): void {
    if (this.again) {
      this.again = false;
      this.renew();
    }
  }

  /** Blends a piece of one more picture, shifted within the pixel, into the one on display. */
  private drawAverage(): void {
    const count = this.pass + 1;
    if (this.work === null) {
      // covers the pixel evenly
      const shift: Shift = [halton(count, 2) - 0.5, halton(count, 3) - 0.5, count];
      this.work = this.begin(1, this.resting.stepsPerVoxel, shift);
    }
    this.marcher.blend = 1 / count;
    const { work } = this;
    this.drawPiece(work, (whole) => {
      if (whole) {
        this.show();
      }
    });
    this.marcher.blend = null;
    if (!work.rows.done) {
      return;
    }
    this.work = null;
    if (this.nextEye()) {
      this.pass = count;
      this.shown = { ...this.shown, passes: count };
      this.endLevel();
    }
  }

  /** Begins a picture at rest over what is on display, with all of the surfaces. */
  private begin(divisor: number, stepsPerVoxel: number, shift: Shift): Work {
    this.turn();
    const { shown, next } = this.picturesOf(this.eye);
    next.useLevel(divisor);
    if (next.width !== shown.width || next.height !== shown.height) {
      this.stretcher.draw(this.renderer, shown, next);
      this.swap(this.eye);
    }
    const target = this.pictureOf(this.eye);
    const { drawn } = this.surfaces.draw(this.renderer, target, {
      divisor,
      stepsPerVoxel,
      shift,
      depth: mostLayers,
      detail: "all",
    });
    this.triangles = this.eye === 0 ? drawn : this.triangles + drawn;
    return { target, stepsPerVoxel, shift, rows: new MiddleOut([0, target.height]), columns: [0, target.width] };
  }

  /** Draws the next rows that fit into a piece's time; calls back once they are there: with true for the last ones. */
  private drawPiece({ target, stepsPerVoxel, shift, rows, columns }: Work, done: (whole: boolean) => void): void {
    const width = columns[1] - columns[0];
    const [from, to] = rows.take(this.pace.pieceRows(Math.max(1, width), target.height, stepsPerVoxel));
    const whole = rows.done;
    target.useRows(from, to, ...columns);
    this.march(target, stepsPerVoxel, shift);
    this.time((milliseconds) => {
      if (width === target.width) {
        // a part of the view may be so small that it tells of waits alone
        this.pace.learnPiece(width * (to - from) * stepsPerVoxel, milliseconds);
      }
      done(whole);
    });
  }

  private march(target: PictureTarget, stepsPerVoxel: number, shift: Shift): void {
    this.marcher.draw(this.renderer, target, { stepsPerVoxel, jitter: this.jitter }, shift);
  }

  /** What was drawn is on display with the next frame. */
  private show(): void {
    this.changed = true;
    this.changedAt = performance.now();
  }

  /** Counts a piece, and tells what it cost, once the GPU has drawn it. */
  private time(done: (milliseconds: number) => void): void {
    this.clock.start((milliseconds) => {
      this.drawnPieces += 1;
      done(milliseconds);
      this.goOnAtOnce();
    });
  }

  /** Draws the next piece at rest without waiting for a frame, unless one has to be shown first where the CPU draws. */
  private goOnAtOnce(): void {
    if (!this.stale && !(this.options.software && this.changed)) {
      this.goOn();
    }
  }

  private goOn(): void {
    if (this.host.mayGoOn()) {
      this.drawNext(performance.now());
    }
  }

  /** Turns to the eye whose picture is drawn; a single one stays where the view left it. */
  private turn(): void {
    if (this.eyePictures.length > 1) {
      this.host.aim(this.eye);
    }
  }

  /** Goes on to the next eye; true where all had their turn. */
  private nextEye(): boolean {
    this.eye = (this.eye + 1) % this.eyePictures.length;
    return this.eye === 0;
  }

  private swap(eye: number): void {
    const pictures = this.picturesOf(eye);
    [pictures.shown, pictures.next] = [pictures.next, pictures.shown];
  }
}
