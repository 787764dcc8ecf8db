/**
 * The picture on its canvas: made as soon as there is a canvas, given all that the page holds, drawn in each frame.
 */
import type { Appearance } from "../../core/appearance/appearance";
import type { Camera } from "../../core/geometry/camera";
import type { Segment } from "../../core/protocol";
import type { Panes } from "../../core/view/picture_layout";
import type { GpuSupport } from "../../gl/base/gpu_support";
import type { FieldFilter } from "../../gl/march/field_filter";
import { Picture } from "../../gl/picture/picture";
import type { SnapshotWish } from "../../gl/picture/snapshot";
import { savedPictures } from "../../live/saved_pictures";
import type { MarkVisibility } from "../features/marks/mark_visibility.svelte";
import type { EditRateControl } from "../features/scan/edit_rate_control.svelte";
import type { ScanLoader } from "../features/scan/scan_loader.svelte";
import type { ShownEdits } from "../features/scan/shown_edits.svelte";
import type { TouchMarkers } from "../features/touch/touch_markers.svelte";
import type { DrawerControl } from "../features/view/drawer_control.svelte";
import type { StereoControl } from "../features/view/stereo_control.svelte";
import type { ViewControl } from "../features/view/view_control.svelte";
import type { Session } from "../state/session.svelte";
import { drawOn } from "./canvas_loop";
import type { DrawnScene } from "./drawn_scene.svelte";
import { FrameRate } from "./frame_rate.svelte";
import { LastPicture } from "./last_picture";
import { PictureSync, type SyncedControls } from "./picture_sync";

/** What is drawn. */
interface Sources extends SyncedControls {
  readonly session: Session;
  readonly loader: ScanLoader;
  readonly scene: DrawnScene;
  readonly view: ViewControl;
  readonly stereo: StereoControl;
  readonly drawer: DrawerControl;
  readonly edits: ShownEdits;
  readonly editRate: EditRateControl;
  readonly touch: TouchMarkers;
  readonly markVisibility: MarkVisibility;
}

export class PictureHost {
  readonly frameRate = new FrameRate();
  /** How the scan's values are filtered; null before there is a canvas. */
  filter = $state.raw<FieldFilter | null>(null);
  /** The browser has lost its graphics, and has not given them back. */
  lost = $state(false);
  /** Nothing is drawn; for the benchmark of edits. */
  suspended = false;

  private picture: Picture | null = null;
  private canvas: HTMLCanvasElement | null = null;
  private drawnCamera: Camera | null = null;
  /** Greetings of engines that the picture knows of. */
  private greetings = 0;
  /** The mode in which was drawn last. */
  private blend: Appearance["optics"]["blend"] | null = null;
  /** Why the engine's pictures did not come in the last frame. */
  private failure: string | null = null;
  private readonly sync: PictureSync;
  private readonly last = new LastPicture();

  constructor(
    private readonly sources: Sources,
    readonly support: GpuSupport,
  ) {
    this.sync = new PictureSync(sources, support.software);
    sources.session.onDrawn((drawn) => this.picture?.takeDrawn(drawn));
  }

  /** Takes a canvas and draws on it until the returned function is called. */
  attach(canvas: HTMLCanvasElement): () => void {
    this.canvas = canvas;
    this.start();
    const end = drawOn(canvas, {
      resized: this.fit.bind(this),
      frame: this.drawFrame.bind(this),
      lost: () => {
        this.drop();
        this.lost = true;
      },
      restored: () => {
        this.start();
        this.lost = this.picture === null;
      },
    });
    return () => {
      end();
      this.drop();
    };
  }

  /** What is drawn; null before there is a canvas and while the graphics are reset. */
  get drawn(): Picture | null {
    return this.picture;
  }

  /** Draws what is seen, or was last before the graphics were lost, into a canvas. */
  drawLast(canvas: HTMLCanvasElement): void {
    if (this.picture !== null) {
      // markers have moved since it was kept
      this.picture.redraw();
      this.drawFrame(performance.now());
    }
    this.last.draw(canvas);
  }

  /** How fine the picture on display is; null before there is one. */
  get shown(): Picture["shown"] | null {
    const { sync, picture } = this;
    if (picture === null) {
      return null;
    }
    // who draws changes with a frame, not with the choice
    const isByChosen = picture.engineDraws === this.sources.drawer.engineDraws;
    return { ...picture.shown, finished: picture.shown.finished && sync.isWhole && isByChosen };
  }

  setAppearance(appearance: Appearance | null): void {
    if (appearance !== null && this.sources.loader.held !== null) {
      if (appearance.optics.blend !== this.blend) {
        this.blend = appearance.optics.blend;
        this.sources.drawer.quicker.forget();
      }
      this.picture?.contents.setAppearance(appearance);
    }
  }

  /** Passes colours, poses and surfaces' appearance to the picture. */
  setSegments(segments: readonly Segment[]): void {
    this.picture?.contents.setSegments(segments, this.sources.scene.inside);
  }

  /** Gives the 3-D view its pane. */
  arrange({ view: pane }: Panes): void {
    const { slices, stereo, touch, view } = this.sources;
    view.resize(stereo.viewport(pane));
    this.picture?.setStereo(stereo.choice);
    if (this.picture?.resize(slices.size.width, slices.size.height, pane) === true) {
      this.sources.drawer.quicker.forget();
    }
    touch.redraw();
  }

  /** Draws a view into a canvas. */
  async snapshot(context: CanvasRenderingContext2D, wish: SnapshotWish): Promise<void> {
    await this.standing.snapshot(context, wish);
  }

  /** Draws one view after another into a canvas, and waits until each was taken. */
  async film(...[context, cameras, wish, taken]: Parameters<Picture["film"]>): Promise<void> {
    await this.standing.film(context, cameras, wish, taken);
  }

  /** Draws nothing any more, or again; edits are uploaded all the same. */
  suspend(on: boolean): void {
    this.suspended = on;
    if (this.picture !== null) {
      this.picture.suspended = on;
    }
  }

  /** Whether rays start at random shares of a step, and pictures are averaged where that is quick. */
  setJitter(on: boolean): void {
    if (this.picture !== null) {
      this.picture.jitter = on;
    }
  }

  /** Gives all that the page holds to a new picture, or a new scan to the picture. */
  fill(): void {
    const { picture } = this;
    const { edits, loader, scene } = this.sources;
    if (picture !== null && loader.held !== null) {
      picture.contents.setScan(loader.held.volume, loader.held.bricks);
      this.setAppearance(scene.appearance);
      edits.showAll(picture);
      this.setSegments(scene.segments);
    }
  }

  /** Uploads edits to the GPU as they come: all of one before anything is drawn again. */
  takeEdits(): void {
    const { edits, loader } = this.sources;
    if (loader.held !== null) {
      edits.show(loader.held, this.picture);
    }
  }

  private get standing(): Picture {
    if (this.picture === null) {
      throw new Error("there is no picture");
    }
    return this.picture;
  }

  /** Makes the picture, also anew after the graphics were reset. */
  private start(): void {
    if (this.canvas === null) {
      return;
    }
    this.drop();
    const { drawer, loader, session, touch } = this.sources;
    const { support } = this;
    loader.endPreview();
    try {
      this.picture = new Picture(this.canvas, {
        support,
        mostPixelRatio: support.software ? 1 : 2,
        askEngine: (message) => {
          session.send(message);
        },
        engineDraws: drawer.wantsEngine,
        engineAnswered: (milliseconds) => {
          drawer.quicker.learnEngine(milliseconds);
        },
        askSaved: savedPictures,
      });
    } catch (error) {
      loader.failure = `the graphics did not start: ${error instanceof Error ? error.message : String(error)}`;
      return;
    }
    this.filter = this.picture.filter;
    this.drawnCamera = null;
    this.sync.forget();
    touch.redraw();
    this.fit();
    this.fill();
  }

  private drop(): void {
    this.picture?.dispose();
    this.picture = null;
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas ?? { clientWidth: 0, clientHeight: 0 };
    if (width > 0 && height > 0) {
      const { slices } = this.sources;
      slices.size = { width, height };
      this.arrange(slices.panes);
    }
  }

  private drawFrame(now: number): void {
    const { editRate, edits, loader, markVisibility } = this.sources;
    const { picture } = this;
    this.frameRate.count(now);
    this.takeEdits();
    editRate.begin(now, edits.lastEdit);
    if (picture === null) {
      return;
    }
    this.sync.pass(picture, now, loader.held !== null);
    this.chooseDrawer(picture);
    this.measureDrawers(picture, now);
    this.show(picture);
    const before = picture.drawing;
    picture.advance(now);
    this.keepLast(picture, picture.drawing !== before);
    loader.follow(picture);
    markVisibility.follow(picture.shown.finished);
  }

  /** Keeps what is on display for when the graphics are lost; `isFresh` where it was drawn in this frame. */
  private keepLast(picture: Picture, isFresh: boolean): void {
    if (this.canvas === null || !picture.shown.finished || picture.isLost || this.last.isOf(picture.drawing)) {
      return;
    }
    if (isFresh || this.support.software) {
      this.last.keep(this.canvas, picture.drawing);
    } else {
      // the canvas has forgotten what an earlier frame drew
      picture.redraw();
    }
  }

  /** Has the engine draw, or this browser. */
  private chooseDrawer(picture: Picture): void {
    const { drawer, session } = this.sources;
    picture.engineDraws = drawer.follow({
      // at first it is about to be
      connected: session.greetings === 0 || session.connection.kind === "open",
      failure: picture.engineFailure,
    });
    if (session.greetings !== this.greetings) {
      this.greetings = session.greetings;
      picture.forgetEngine();
    }
  }

  /** Has a picture of the one timed that is not known, and of an engine that has failed after a while. */
  private measureDrawers(picture: Picture, now: number): void {
    const { drawer, session } = this.sources;
    const failure = picture.engineFailure;
    if (failure !== null && failure !== this.failure && drawer.wantsEngine) {
      session.notify("warning", `This browser draws the picture: ${failure}.`);
    }
    this.failure = failure;
    const due = drawer.look(now, failure !== null);
    if (due === "engine") {
      picture.tryEngine();
    } else if (due === "browser" && picture.shown.finished) {
      const milliseconds = picture.timeBrowser();
      if (milliseconds !== null) {
        drawer.quicker.learnBrowser(milliseconds);
      }
    }
  }

  /** Passes what moves from frame to frame: the camera, poses, and what of touch is drawn. */
  private show(picture: Picture): void {
    const { edits, session, touch, view } = this.sources;
    const { camera, content } = view;
    if (camera === null || content === null) {
      return;
    }
    if (camera !== this.drawnCamera) {
      picture.setCamera(camera, content);
      this.drawnCamera = camera;
      touch.redraw();
    }
    picture.contents.setPoses(session.latest?.poses ?? []);
    picture.contents.setDeforming(edits.displaced.length > 0 || (session.latest?.matter.model ?? null) !== null);
    view.tell();
    touch.pass(picture, camera, view.viewport);
  }
}
