/**
 * The 3-D picture: scan and markers on one canvas, for one eye or for two. Nothing is drawn unless
 * something has changed; the engine's rates never depend on it.
 */
import * as THREE from "three";
import type { Camera, Extent } from "../../core/geometry/camera";
import type { Rect } from "../../core/view/picture_layout";
import { firstQuality, restingPictures, type QualityChoice } from "../../core/view/quality";
import { everywhere, type Region } from "../../core/view/region";
import type { DrawnPicture, DrawPicture, PictureFailed, PictureLook } from "../../core/protocol";
import { eyeCamera, eyesOf, viewportOf, type Stereo } from "../../core/view/stereo";
import { Compositor } from "./compositor";
import { EngineDrawing } from "../engine_pictures/engine_drawing";
import type { EngineFrame } from "../engine_pictures/engine_pictures";
import type { AskSaved } from "./engine_snapshot";
import { DrawnScan } from "../textures/drawn_scan";
import { DrawnScreen } from "./drawn_screen";
import type { FieldFormat } from "../textures/field_texture";
import { GpuClock } from "../base/gpu_clock";
import type { GpuSupport } from "../base/gpu_support";
import { chooseFilter, type FieldFilter } from "../march/field_filter";
import type { PictureTarget } from "../base/picture_target";
import { RayMarcher } from "../march/ray_marcher";
import { Refiner, type Shown } from "./refiner";
import { PictureContents } from "./picture_contents";
import { PictureSaving } from "./picture_saving";
import type { SnapshotWish } from "./snapshot";
import { Slices } from "./slices";
import { Surfaces } from "../surfaces/surfaces";
import { drawTimed, type TimedPicture, type TimedWish } from "./timed_picture";
import { ThreeCamera } from "../base/three_camera";
import { ViewPane } from "./view_pane";

/** Cells along the scan's longest edge in which its light is worked out. */
const lightCells = { gpu: 128, software: 64 } as const;

/** Of the resolution, in which the browser's drawing is timed. */
const timedDivisor = 4;

export interface PictureOptions {
  readonly support: GpuSupport;
  /** Device pixels per CSS pixel, at most. */
  readonly mostPixelRatio: number;
  /** Another format for the scan's values than the one that is measured to be the best. */
  readonly format?: FieldFormat;
  /** Asks the engine for pictures; it draws none where this is left out. */
  readonly askEngine?: (message: DrawPicture | PictureLook) => void;
  /** Is told how long each picture of the engine took while the view moved, from its request until it came [ms]. */
  readonly engineAnswered?: (milliseconds: number) => void;
  /** The engine draws from the start. */
  readonly engineDraws?: boolean;
  /** Asks the engine for pictures that are saved, where it draws; in strips. */
  readonly askSaved?: AskSaved;
}

export class Picture {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly marcher: RayMarcher;
  private readonly compositor = new Compositor();
  private readonly surfaces: Surfaces;
  private readonly refiner: Refiner;
  private readonly pane: ViewPane;
  private readonly slices: Slices;
  private readonly screen: DrawnScreen;
  /** What is shown. */
  readonly contents: PictureContents;
  /** How the GPU filters the scan's values. */
  readonly filter: FieldFilter;
  /** Nothing is drawn, and all is uploaded as always: for the benchmark of edits. */
  suspended = false;
  private readonly scan: DrawnScan;
  private readonly engine: EngineDrawing;
  /** The engine draws, and not the ray caster. */
  private byEngine: boolean;
  /** The GPU has what it needs for whoever draws. */
  private composes = false;
  /** The GPU has the programs for a first picture, or cannot have them before it. */
  private prepared: boolean | "soon" = false;
  private quality: QualityChoice;
  /** There was a picture of a scan: before it nothing else is drawn, since each program takes its time to be made. */
  private begun = false;
  private view: { readonly camera: Camera; readonly extent: Extent } | null = null;
  /** What was last drawn, or is. */
  private aimed: { readonly camera: Camera; readonly extent: Extent } | null = null;
  private readonly eyeCamera = new ThreeCamera();
  private readonly saving: PictureSaving;
  private readonly closing = new AbortController();

  constructor(canvas: HTMLCanvasElement, options: PictureOptions) {
    const { support } = options;
    this.marcher = new RayMarcher({
      software: support.software,
      lightCells: support.software ? lightCells.software : lightCells.gpu,
    });
    this.slices = new Slices(this.marcher);
    this.renderer = new THREE.WebGLRenderer({
      canvas,
      // smooth edges of the markers; the scan's own are smoothed by averaging
      antialias: !support.software,
      alpha: false,
      stencil: false,
      powerPreference: "high-performance",
      // where the CPU draws, only what has changed around the markers is drawn again
      preserveDrawingBuffer: support.software,
    });
    this.renderer.autoClear = false;
    this.renderer.outputColorSpace = THREE.SRGBColorSpace;
    this.filter = options.format === undefined ? chooseFilter(this.renderer) : { format: options.format, errors: {} };
    this.scan = new DrawnScan(this.filter.format);
    this.surfaces = new Surfaces(this.marcher, support.halfFloatTarget);
    const askEngine = options.askEngine ?? (() => undefined);
    this.engine = new EngineDrawing(this.renderer, this.marcher, support.halfFloatTarget, askEngine);
    this.engine.pictures.onAnswer = options.engineAnswered ?? (() => undefined);
    this.byEngine = options.engineDraws ?? false;
    this.quality = firstQuality(support.software);
    const means = { software: support.software, halfFloat: support.halfFloatTarget };
    this.refiner = new Refiner(
      this.renderer,
      new GpuClock(this.gl),
      this.marcher,
      this.surfaces,
      means,
      {
        aim: (eye) => { this.aimEye(eye); },
        present: () => { this.present(); },
        mayGoOn: () => this.begun && !this.byEngine && !this.suspended && !this.saving.holdsScreen,
        isLoaded: () => this.begun && !this.scan.isLoading,
      },
    );
    this.setQuality(this.quality);
    const shown = (eye: number): PictureTarget => this.engine.standIn(eye) ?? this.refiner.pictureOf(eye);
    this.pane = new ViewPane(this.renderer, this.compositor, shown);
    this.screen = new DrawnScreen(this.renderer, this.pane, this.slices, support.software, options.mostPixelRatio);
    this.contents = new PictureContents({
      renderer: this.renderer,
      marcher: this.marcher,
      surfaces: this.surfaces,
      compositor: this.compositor,
      slices: this.slices,
      scan: this.scan,
      refiner: this.refiner,
      engine: this.engine,
      pane: this.pane,
      drawnByEngine: () => this.byEngine,
      slicesChanged: () => { this.screen.stale = true; },
    });
    this.saving = new PictureSaving({
      renderer: this.renderer,
      marcher: this.marcher,
      surfaces: this.surfaces,
      compositor: this.compositor,
      refiner: this.refiner,
      pane: this.pane,
      engine: this.engine,
      support,
      askSaved: options.askSaved ?? noneSaved,
      aim: (camera, extent, aspect) => {
        this.aim(camera, extent, aspect);
        return this.eyeCamera.camera;
      },
      redraw: () => { this.screen.stale = true; },
    });
    const programs = [this.engine.prepare(), this.compositor.prepare(this.renderer)];
    void Promise.allSettled(programs).then(() => {
      this.composes = true;
    });
    if (!this.byEngine) {
      this.prepare();
    }
  }

  get isPrepared(): boolean {
    return this.composes && (this.byEngine || this.prepared === true);
  }

  /** Who draws. */
  get engineDraws(): boolean {
    return this.byEngine;
  }

  set engineDraws(on: boolean) {
    if (on !== this.byEngine) {
      this.byEngine = on;
      this.engine.pictures.forget();
      this.engine.leave();
      this.refiner.recount();
      this.refiner.restart();
    }
  }

  /** Takes a picture that the engine has drawn, or word that it has not. */
  takeDrawn(answer: DrawnPicture | PictureFailed): void {
    this.engine.take(answer);
  }

  /** Why the engine's pictures do not come; null where they do. */
  get engineFailure(): string | null {
    return this.engine.pictures.failure;
  }

  /** Asks the engine for a picture while the browser draws, to learn whether and how soon one comes. */
  tryEngine(): void {
    if (this.view !== null) {
      this.engine.pictures.probe(this.view, this.engineFrame);
    }
  }

  /**
   * How long a picture of the browser takes, as fine as one of a view that turns should be at least [ms]; null until
   * its programs are made, for which nothing waits.
   */
  timeBrowser(): number | null {
    this.prepare();
    const { target } = this.refiner.pictureOf(0);
    if (this.prepared !== true || !this.scan.ready || this.scan.isLoading || this.view === null) {
      return null;
    }
    this.aim(this.view.camera, this.view.extent, target.width / target.height);
    const [width, height] = [Math.ceil(target.width / timedDivisor), Math.ceil(target.height / timedDivisor)];
    return drawTimed(this.renderer, this.marcher, this.surfaces, { width, height, stepsPerVoxel: 1 }).milliseconds;
  }

  /** Another engine has greeted the page, or the same again. */
  forgetEngine(): void {
    this.engine.pictures.forget();
    this.engine.pictures.failure = null;
    this.refiner.restart();
  }

  /** Share of the scan that is on the GPU. */
  get uploaded(): number {
    return this.scan.uploaded;
  }

  /** Planes that are drawn with their own values; in others something stands in for them. */
  get arrived(): number {
    return this.scan.arrived;
  }

  /** A picture of the scan, with all of the values that were given, is on the screen. */
  get hasPicture(): boolean {
    const { refiner, scan } = this;
    return this.byEngine
      ? this.pieces > 0
      : !scan.isLoading && scan.ready && refiner.drawnPieces > 0 && !refiner.awaitsFrame;
  }

  /** With what the picture on display was drawn, and whether it is final. */
  get shown(): Shown & { readonly finished: boolean } {
    const whole =
      this.begun &&
      !this.scan.isLoading &&
      !this.screen.stale &&
      !this.slices.isStale &&
      !this.marcher.second.isAwaited;
    return this.byEngine
      ? { ...this.engine.shown, finished: this.engine.pictures.finished && !this.refiner.isStale && whole }
      : { ...this.refiner.shown, finished: this.refiner.finished && whole };
  }

  /** What stands on the canvas, by identity: the same as long as nothing but markers is drawn again. */
  get drawing(): symbol {
    return this.screen.drawing;
  }

  /** Whether the browser has lost its graphics, also before it tells so. */
  get isLost(): boolean {
    return this.gl.isContextLost();
  }

  /** Has all be drawn again with the next frame. */
  redraw(): void {
    this.screen.stale = true;
  }

  /** How fine pictures are at rest, those that are saved too, and how long they may take while the view moves. */
  setQuality(quality: QualityChoice): void {
    this.quality = quality;
    this.refiner.setQuality(restingPictures[quality.quality], quality.frameBudget);
    this.engine.pictures.resting = restingPictures[quality.quality];
  }

  set jitter(on: boolean) {
    if (on !== this.refiner.jitter) {
      this.refiner.jitter = on;
      this.engine.pictures.jitter = on;
      this.refiner.restart();
    }
  }

  setCamera(camera: Camera, extent: Extent): void {
    this.view = { camera, extent };
    this.refiner.restart();
  }

  /** One picture, or one for each eye; followed by `resize`. */
  setStereo(stereo: Stereo): void {
    if (stereo !== this.pane.stereo) {
      this.pane.setStereo(stereo);
      this.refiner.eyes = eyesOf(stereo, this.pane.rect).length;
    }
  }

  /**
   * Follows the size of the canvas on the page and the place of the 3-D view on it [CSS pixels]; true where pictures
   * have another size from now on.
   */
  resize(width: number, height: number, pane: Rect = { x: 0, y: 0, width, height }): boolean {
    const { target } = this.refiner.pictureOf(0);
    const before = [target.width, target.height];
    const ratio = this.screen.resize({ width, height }, pane);
    const drawn = eyesOf(this.pane.stereo, pane)[0]?.rect ?? pane;
    this.refiner.resize(Math.floor(drawn.width * ratio), Math.floor(drawn.height * ratio));
    return target.width !== before[0] || target.height !== before[1];
  }

  /** Does the work of one frame; `now` [ms]. */
  advance(now: number): void {
    this.upload();
    if (this.byEngine) {
      this.advanceByEngine();
      return;
    }
    this.engine.pictures.watch();
    this.prepare();
    if (!this.scan.ready || this.view === null || this.suspended || this.saving.holdsScreen) {
      return;
    }
    if (!this.isPrepared) {
      if (this.begun) {
        // markers go on over the engine's last picture until the browser can draw
        this.show(null);
      }
      return;
    }
    if (this.scan.comesWhole && !this.refiner.isStale) {
      // all of the scan is drawn soon: what is on display stays until then, however fine it could be
      return;
    }
    if (this.marcher.second.isAwaited) {
      if (this.marcher.uploadSecond(this.renderer)) {
        this.slices.follow(this.scan.frame);
        this.refiner.restart();
      }
      return;
    }
    this.show(this.refiner.advance(now) ? everywhere : null);
  }

  private advanceByEngine(): void {
    const { engine, view } = this;
    if (this.scan.frame === null || !this.composes || view === null || this.suspended || this.saving.holdsScreen) {
      return;
    }
    if (this.marcher.second.isAwaited && this.marcher.uploadSecond(this.renderer)) {
      // slices are drawn here
      this.slices.follow(this.scan.frame);
    }
    const frame = this.engineFrame;
    const drawn = engine.advance({
      changed: this.refiner.takeChange(),
      view,
      screen: { frame, targets: frame.asides.map((_, eye) => this.refiner.pictureOf(eye)) },
      aim: ({ camera, extent }) => { this.aim(camera, extent, frame.size[0] / frame.size[1]); },
      look: ({ camera, extent }) => { this.pane.look(camera, extent); },
    });
    if (drawn !== null || !engine.pictures.isTurning) {
      this.show(drawn);
    }
  }

  /** What the engine is asked for; of pictures that are squeezed into their places all of the pixels. */
  private get engineFrame(): EngineFrame {
    const { rect, stereo } = this.pane;
    const eyes = eyesOf(stereo, rect);
    const { target } = this.refiner.pictureOf(0);
    const [seen, drawn] = [viewportOf(stereo, rect), eyes[0]?.rect ?? rect];
    return {
      size: [
        Math.round((target.width * seen.width) / drawn.width),
        Math.round((target.height * seen.height) / drawn.height),
      ],
      asides: eyes.map(({ aside }) => aside),
    };
  }

  /** Brings what was drawn to the screen, in a region of the picture, and what else has changed there. */
  private show(drawn: Region | null): void {
    this.screen.fit();
    if (this.begun) {
      this.screen.draw(drawn, () => (this.surfaces.stray || this.byEngine ? null : this.marcher.outline));
    } else {
      this.begin(drawn !== null);
    }
  }

  /** Has the GPU make what the ray caster needs; once. */
  private prepare(): void {
    if (this.prepared === false) {
      this.prepared = "soon";
      void this.refiner.prepare(this.scan.format).finally(() => {
        this.prepared = true;
      });
    }
  }

  /**
   * Draws a view of the scan and its surfaces into a canvas, for one eye or for two; the screen stays as it is
   * meanwhile, unless the engine draws.
   *
   * @throws where there is no picture yet, a snapshot is drawn already or the wish is aborted.
   */
  async snapshot(context: CanvasRenderingContext2D, wish: SnapshotWish): Promise<void> {
    const { camera, ...rest } = wish;
    await this.film(context, [camera], rest, () => Promise.resolve());
  }

  /**
   * Draws one view after another into a canvas, as `snapshot` draws one.
   *
   * @param taken waits until a view was taken from the canvas.
   */
  async film(
    context: CanvasRenderingContext2D,
    cameras: readonly Camera[],
    wish: Omit<SnapshotWish, "camera">,
    taken: (view: number) => Promise<void>,
  ): Promise<void> {
    // the engine's strips are of one eye
    const byEngine = this.byEngine && wish.stereo.mode === "off";
    const isReady = byEngine ? this.scan.frame !== null && this.composes : this.scan.ready;
    if (!isReady || this.view === null || this.saving.isBusy) {
      throw new Error("the picture is not ready");
    }
    const now = { extent: this.view.extent, quality: restingPictures[this.quality.quality] };
    const signal = AbortSignal.any([wish.signal, this.closing.signal]);
    if (byEngine) {
      await this.saving.byEngine(context, cameras, { ...wish, signal }, now, taken);
    } else {
      await this.saving.byBrowser(context, cameras, { ...wish, signal }, now, taken);
    }
  }

  /** Pictures and strips that the GPU has drawn to the end. */
  get pieces(): number {
    return this.byEngine ? this.engine.pictures.count : this.refiner.drawnPieces;
  }

  /** Slices that were drawn. */
  get drawnSlices(): number {
    return this.slices.drawn;
  }

  /**
   * Numbers of the engine's pictures: of the last request, of the one on display, turned or not, and how many turned
   * ones were drawn; null where the browser draws.
   */
  get engineNumbers(): { readonly requested: number; readonly shown: number; readonly turns: number } | null {
    const { answered: shown, requested } = this.engine.pictures;
    return this.byEngine ? { requested, shown, turns: this.engine.turns } : null;
  }

  /** Draws the view once, away from the screen; null before there is one. */
  drawTimed(wish: TimedWish): TimedPicture | null {
    if (!this.scan.ready || this.view === null) {
      return null;
    }
    this.aim(this.view.camera, this.view.extent, wish.width / wish.height);
    const drawn = drawTimed(this.renderer, this.marcher, this.surfaces, wish);
    this.refiner.restart();
    return drawn;
  }

  dispose(): void {
    this.closing.abort(new Error("the graphics were reset"));
    this.refiner.dispose();
    this.engine.dispose();
    this.marcher.dispose();
    this.surfaces.dispose();
    this.slices.dispose();
    this.compositor.dispose();
    this.pane.dispose();
    this.scan.dispose();
    this.contents.dispose();
    this.renderer.dispose();
  }

  /** Sends the next values to the GPU, and draws what has come there from now on. */
  private upload(): void {
    const taken = this.saving.holdsScreen ? null : this.scan.upload(this.renderer);
    if (taken === null) {
      return;
    }
    if (taken.isNew) {
      this.marcher.setField(taken.field, taken.bricks);
    } else {
      this.marcher.setBricks(taken.bricks);
    }
    this.slices.changed();
    if (taken.isWhole) {
      this.marcher.light.changed();
      this.refiner.recount();
      if (!this.byEngine) {
        this.refiner.restart();
      }
    } else {
      this.refiner.renew();
    }
  }

  /** Turns ray caster and surfaces to what an eye sees. */
  private aimEye(eye: number): void {
    const { rect, stereo } = this.pane;
    const place = eyesOf(stereo, rect)[eye];
    if (this.view !== null && place !== undefined) {
      const { camera, extent } = this.view;
      const { width, height } = viewportOf(stereo, rect);
      this.aimed = this.view;
      this.aim(eyeCamera(camera, place.aside), extent, width / height);
    }
  }

  /** What was aimed at last is on display: markers are seen in the same view from the same frame on. */
  private present(): void {
    if (this.aimed !== null) {
      this.pane.look(this.aimed.camera, this.aimed.extent);
    }
  }

  /** Takes ray caster and surfaces to a view. */
  private aim(camera: Camera, extent: Extent, aspect: number): void {
    this.marcher.setCamera(camera, extent, aspect);
    this.eyeCamera.update(camera, extent, aspect);
    this.surfaces.setCamera(camera, this.eyeCamera.camera);
  }

  private get gl(): WebGL2RenderingContext {
    return this.renderer.getContext() as WebGL2RenderingContext;
  }

  /** Draws the picture of the scan alone; once it stands all else follows. */
  private begin(drawn: boolean): void {
    if (drawn) {
      this.screen.drawPicture();
    }
    this.begun = this.pieces > 0;
    this.screen.stale = this.begun;
  }
}

/** There is no engine. */
function noneSaved(): never {
  throw new Error("the engine is not connected");
}
