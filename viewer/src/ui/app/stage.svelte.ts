/**
 * What stands on the stage: the scan, the controls of its picture, and what is drawn in each frame.
 * Joins the engine's state (`Session`) with the GPU (`Picture`).
 */
import { transformPoint } from "../../core/geometry/affine";
import type { BrickRanges } from "../../core/scan/bricks";
import { extentOf, type Camera } from "../../core/geometry/camera";
import { contentHull } from "../../core/scan/content_hull";
import type { Appearance } from "../../core/appearance/appearance";
import type { Panes } from "../../core/view/picture_layout";
import type { Fusion } from "../../core/second/second_scan";
import type { Scan, Segment } from "../../core/protocol";
import { frameOf, type ScanVolume } from "../../core/scan/scan_volume";
import { drawnKey, LastRanges, rangesInside, showable, shownRanges } from "../../core/segments/shown_segments";
import { biasedRange } from "../../core/scan/stored_values";
import { KeepEqual } from "../../core/base/keep_equal";
import type { GpuSupport } from "../../gl/base/gpu_support";
import { Picture } from "../../gl/picture/picture";
import type { SnapshotWish } from "../../gl/picture/snapshot";
import { downloadLabels } from "../../live/volume_download";
import { BrushControl } from "../features/segments/brush_control.svelte";
import { drawOn } from "./canvas_loop";
import { ClipControl } from "../features/view/clip_control.svelte";
import { CutControl } from "../features/segments/cut_control.svelte";
import { EditRateControl } from "../features/scan/edit_rate_control.svelte";
import { EngineSteps } from "../state/engine_steps.svelte";
import { FrameRate } from "./frame_rate.svelte";
import { GrowControl } from "../features/segments/grow_control.svelte";
import { PictureSync } from "./picture_sync";
import { ImageControl } from "../features/view/image_control.svelte";
import { AppearanceControl } from "../features/appearance/appearance_control.svelte";
import { MarkControl } from "../features/marks/mark_control.svelte";
import { MarkVisibility } from "../features/marks/mark_visibility.svelte";
import { ObjectControl } from "../features/segments/object_control.svelte";
import { PageSteps } from "../state/page_steps.svelte";
import { Picker } from "./picker";
import type { ShownTouch } from "../../core/touch/shown_touch";
import { Player } from "../features/scenario/player.svelte";
import { QualityControl } from "../features/view/quality_control.svelte";
import { Readout } from "../features/picking/readout.svelte";
import { RegistrationControl } from "../features/second/registration_control.svelte";
import { mostValues, ScanLoader } from "../features/scan/scan_loader.svelte";
import { SecondControl } from "../features/second/second_control.svelte";
import { SegmentAppearance } from "../features/segments/segment_appearance";
import type { Session } from "../state/session.svelte";
import { needsLabels, ShownEdits, type HeldScan } from "../features/scan/shown_edits.svelte";
import { SliceControl } from "../features/slices/slice_control.svelte";
import { StereoControl } from "../features/view/stereo_control.svelte";
import { TouchMarkers } from "../features/touch/touch_markers.svelte";
import { ViewControl } from "../features/view/view_control.svelte";

/** How a large scan is shown while it arrives: where the CPU draws, that takes of the time in which the whole one could be there. */
const shownParts = { gpu: { parts: 8, soon: 1000 }, software: { parts: 4, soon: 4000 } } as const;

export class Stage {
  /** The scan, on its way or here. */
  readonly loader: ScanLoader;
  /** Where it is seen from. */
  readonly view: ViewControl;
  /** The slices beside it. */
  readonly slices: SliceControl;
  /** What each eye sees of the 3-D view. */
  readonly stereo: StereoControl;
  /** How fine it is drawn. */
  readonly quality: QualityControl;
  /** How the scan is shown. */
  readonly looks: AppearanceControl;
  /** How segments look. */
  readonly segmentAppearance: SegmentAppearance;
  /** What of the 3-D view is cut away. */
  readonly clips: ClipControl;
  /** Range of a segment while its slider is dragged, before the engine is asked. */
  preview = $state.raw<{ readonly id: number; readonly range: readonly [number, number] } | null>(null);
  /** What of touch is drawn. */
  readonly touch: TouchMarkers;
  /** Edits of the voxels, and the surfaces of segments. */
  readonly edits: ShownEdits;
  /** How often the picture follows them. */
  readonly editRate: EditRateControl;
  /** Segments that are moved. */
  readonly objects: ObjectControl;
  /** Plays scenarios: their tool stands in the picture then, and not the probe. */
  readonly player: Player;
  /** A segment that is cut along a painted line. */
  readonly cutting: CutControl;
  /** Segments that are found in the scan. */
  readonly growing: GrowControl;
  /** The brush in slices. */
  readonly brush: BrushControl;
  /** What was clicked last: what it is, where, and how much. */
  readonly readout = new Readout();
  /** A second scan that is shown with the first. */
  readonly second: SecondControl;
  /** How it is brought to the first. */
  readonly registration: RegistrationControl;
  /** Steps of undo that only the page knows, in their order. */
  readonly steps: PageSteps;
  /** How many of the engine came before each. */
  readonly engineSteps: EngineSteps;
  /** Points, distances and angles that a person has set. */
  readonly marks: MarkControl;
  /** Which of them something stands before. */
  readonly sight: MarkVisibility;
  /** What is where in the picture. */
  readonly picker: Picker;
  /** Pictures and films of it as files. */
  readonly images: ImageControl;
  readonly frameRate = new FrameRate();

  drawingSuspended = false;

  private picture: Picture | null = null;
  private canvas: HTMLCanvasElement | null = null;
  private drawnCamera: Camera | null = null;
  private readonly handed: PictureSync;
  private readonly lastRanges = new LastRanges();
  private readonly sameSegments = new KeepEqual<readonly Segment[]>();
  private readonly sameLook = new KeepEqual<Appearance>();
  /** The view of a coarse picture, unless a person turns it. */
  private previewCamera: Camera | null = null;

  constructor(
    private readonly session: Session,
    readonly support: GpuSupport,
    token: string,
  ) {
    this.view = new ViewControl(session);
    this.steps = new PageSteps(() => this.engineSteps.count);
    this.engineSteps = new EngineSteps(session, this.steps);
    this.slices = new SliceControl(this.steps, () => this.view.camera);
    this.stereo = new StereoControl(() => this.view.camera, () => this.slices.panes.view);
    this.looks = new AppearanceControl(this.steps);
    this.segmentAppearance = new SegmentAppearance(session, this.steps);
    this.quality = new QualityControl(support.software);
    this.loader = new ScanLoader({
      token,
      largestEdge: support.largestEdge,
      preview: this.showCoarsely.bind(this),
      refine: (volume, { bricks, arrived }) => {
        this.picture?.refineScan(volume, bricks, arrived);
      },
      shownParts: support.software ? shownParts.software : shownParts.gpu,
      show: this.show.bind(this),
      warn: (text) => {
        session.notify("warning", text);
      },
    });
    this.objects = new ObjectControl(session);
    this.editRate = new EditRateControl(session);
    this.cutting = new CutControl(session);
    this.growing = new GrowControl(session);
    this.brush = new BrushControl(session);
    this.clips = new ClipControl(this.steps);
    this.marks = new MarkControl(this.steps);
    this.player = new Player(session);
    this.touch = new TouchMarkers(session, this.player, support.software);
    this.picker = new Picker(this, session);
    this.sight = new MarkVisibility(this.marks, this.picker.hides.bind(this.picker));
    this.second = new SecondControl({
      steps: this.steps,
      token,
      first: () => session.scan?.name ?? "",
      limits: { edge: support.largestEdge, values: mostValues },
      complain: (text) => {
        session.notify("error", text);
      },
    });
    this.registration = new RegistrationControl(session, this.second, { steps: this.steps, token });
    session.onSecond((told) => {
      this.registration.follow(told.scan?.name ?? null);
      void this.second.take(told);
    });
    session.onRegistration((told) => {
      this.registration.take(told);
    });
    this.images = new ImageControl(this, session);
    this.handed = new PictureSync(this, support.software);
    this.edits = new ShownEdits({
      complain: (text) => {
        session.notify("error", text);
      },
      download: (volume) => downloadLabels(volume, token),
    });
    session.onChanged((changed, arrived) => {
      this.edits.add(changed, arrived);
      this.takeEdits();
    });
    session.onState((state) => {
      if (!this.player.showing) {
        this.touch.add(state.time, state.proxy);
        this.slices.follow(state.proxy);
      }
    });
  }

  /** Takes the slices and the line of the way along with a scenario's tool. */
  followPlayed({ time, proxy }: ShownTouch): void {
    this.touch.add(time, proxy);
    if (this.slices.habits.follows) {
      this.slices.goTo(proxy);
    }
  }

  /** Takes the brush and shows slices to paint in, or puts it away. */
  toggleBrush(): void {
    this.brush.arm(!this.brush.armed);
    if (this.brush.armed) {
      this.showSlices();
    }
  }

  /** Waits for clicks on pairs of points, and shows slices to set them in. */
  placePairs(): void {
    this.marks.cancel();
    this.growing.armed = false;
    this.registration.startPair();
    this.showSlices();
  }

  /** Shows both scans by a fusion in slices. */
  compare(fusion: Fusion): void {
    this.second.change({ inSlices: true, fusion });
    this.showSlices();
  }

  private showSlices(): void {
    if (this.slices.habits.layout === "view") {
      this.slices.change({ layout: "four" });
    }
  }

  /** Takes a canvas and draws on it until the returned function is called. */
  attach(canvas: HTMLCanvasElement): () => void {
    this.canvas = canvas;
    this.startPicture();
    const end = drawOn(canvas, {
      resized: this.fit.bind(this),
      frame: this.drawFrame.bind(this),
      lost: this.dropPicture.bind(this),
      restored: this.startPicture.bind(this),
    });
    return () => {
      end();
      this.dropPicture();
    };
  }

  /** Downloads a scan and shows it. */
  async open(scan: Scan): Promise<void> {
    const scanFrame = frameOf(scan);
    this.edits.clear();
    this.steps.clear();
    this.looks.open(scan);
    this.clips.open(scan.name, scanFrame);
    this.slices.open(scan);
    this.brush.open(scan);
    this.marks.open(scan);
    this.readout.close();
    this.previewCamera = null;
    await this.loader.open(scan);
  }

  /** Shows a large scan coarsely while all of it is on its way. */
  private showCoarsely(volume: ScanVolume, bricks: BrickRanges, scan: Scan): boolean {
    const { picture, look } = this;
    if (picture === null || look === null) {
      return false;
    }
    this.measure(volume, bricks, scan);
    this.view.reset();
    this.previewCamera = this.view.camera;
    picture.setScan(volume, bricks);
    picture.setLook(look);
    picture.setSegments(this.segments, this.looks.inside);
    return true;
  }

  /** Segments as the picture can show them now. */
  readonly segments = $derived.by((): readonly Segment[] => {
    const { preview, edits } = this;
    const { awaitsLabels } = edits;
    const segments = this.session.segments.map((segment) =>
      showable(
        this.lastRanges.stand(segment, awaitsLabels),
        edits.sizes.has(segment.id),
        segment.id === preview?.id ? preview.range : null,
      ),
    );
    // each edit tells of other numbers of voxels, and the picture is hardly ever another one by that
    return this.sameSegments.of(segments, drawnKey(segments));
  });

  /** Hands colours, poses and surfaces' looks to the picture. */
  applySegments(segments: readonly Segment[]): void {
    this.picture?.setSegments(segments, this.looks.inside);
  }

  /** Shows the segments that are no threshold; `version` tells when their voxels have changed. */
  showLabels(segments: readonly Segment[], version: number): void {
    const { held } = this.loader;
    if (held !== null) {
      const key = needsLabels(segments) ? version : null;
      void this.edits.showLabels(key, held.volume, () => this.picture);
    }
  }

  /** The look that the page's controls ask for; null before there is a scan. */
  readonly look = $derived.by((): Appearance | null => {
    const { scan } = this.session;
    const { parts } = this.looks;
    if (scan === null || parts === null) {
      return null;
    }
    const ranges = rangesInside(shownRanges(this.segments, scan), this.looks.inside);
    const look = { ...parts, ranges };
    return this.sameLook.of(look, JSON.stringify(look));
  });

  /** Hands the look to the picture. */
  applyLook(look: Appearance | null): void {
    if (look !== null && this.loader.held !== null) {
      this.picture?.setLook(look);
    }
  }

  /** Whether the CPU draws. */
  get software(): boolean {
    return this.support.software;
  }

  /** Moves the picture so that the probe is in its middle. */
  centreOnProbe(): void {
    const { latest } = this.session;
    if (latest !== null) {
      this.view.centreOn(latest.proxy);
    }
  }

  /** Draws a view into a canvas. */
  async snapshot(context: CanvasRenderingContext2D, wish: SnapshotWish): Promise<void> {
    if (this.picture === null) {
      throw new Error("there is no picture");
    }
    await this.picture.snapshot(context, wish);
  }

  /** What is drawn; for benchmarks. */
  get drawn(): Picture | null {
    return this.picture;
  }

  /** How fine the picture on display is; null before there is one. */
  get shown(): Picture["shown"] | null {
    const { handed, picture } = this;
    return picture && { ...picture.shown, finished: picture.shown.finished && handed.isWhole };
  }

  /** Draws nothing any more, or again; edits are uploaded all the same. For the benchmark of edits. */
  suspendDrawing(on: boolean): void {
    this.drawingSuspended = on;
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

  private show({ volume, bricks }: HeldScan, scan: Scan): void {
    this.measure(volume, bricks, scan);
    if (this.previewCamera === null || this.view.camera === this.previewCamera) {
      this.view.reset();
    }
    this.fillPicture();
    this.showLabels(this.session.segments, this.session.labels);
  }

  /** Finds where the body stands in the scan. */
  private measure(volume: ScanVolume, bricks: BrickRanges, scan: Scan): void {
    const air = scan.soft_tissue - 1.5 * (scan.bone - scan.soft_tissue);
    const [low, high] = biasedRange(air, Math.max(scan.range[1], air), volume.frame.rescale);
    const { frame: scanFrame, step } = volume;
    const hull = contentHull(bricks, step, scanFrame.spacing, (from, to) => from <= high && low <= to);
    this.view.content = extentOf(hull.map((point) => transformPoint(scanFrame.sceneFromGrid, point)));
  }

  /** Makes the picture, also anew after the graphics were reset. */
  private startPicture(): void {
    if (this.canvas === null) {
      return;
    }
    this.dropPicture();
    this.loader.endPreview();
    try {
      this.picture = new Picture(this.canvas, { support: this.support, mostPixelRatio: this.support.software ? 1 : 2 });
    } catch (error) {
      this.loader.failure = `the graphics did not start: ${error instanceof Error ? error.message : String(error)}`;
      return;
    }
    this.drawnCamera = null;
    this.handed.forget();
    this.touch.redraw();
    this.fit();
    this.fillPicture();
  }

  private dropPicture(): void {
    this.picture?.dispose();
    this.picture = null;
  }

  /** Hands everything that the page holds to a new picture, or a new scan to the picture. */
  private fillPicture(): void {
    const { picture } = this;
    const { held } = this.loader;
    if (picture !== null && held !== null) {
      picture.setScan(held.volume, held.bricks);
      this.applyLook(this.look);
      this.edits.showAll(picture);
      picture.setSegments(this.segments, this.looks.inside);
    }
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas ?? { clientWidth: 0, clientHeight: 0 };
    if (width > 0 && height > 0) {
      this.slices.size = { width, height };
      this.arrange(this.slices.panes);
    }
  }

  /** Gives the 3-D view its pane. */
  arrange({ view }: Panes): void {
    const { size } = this.slices;
    this.view.resize(this.stereo.viewport(view));
    this.picture?.setStereo(this.stereo.choice);
    this.picture?.resize(size.width, size.height, view);
    this.touch.redraw();
  }

  private drawFrame(now: number): void {
    this.frameRate.count(now);
    const { picture } = this;
    const { camera, content } = this.view;
    this.takeEdits();
    this.editRate.begin(now, this.edits.lastEdit);
    if (picture === null) {
      return;
    }
    this.handed.hand(picture, now, this.loader.held !== null);
    if (camera !== null && content !== null) {
      if (camera !== this.drawnCamera) {
        picture.setCamera(camera, content);
        this.drawnCamera = camera;
        this.touch.redraw();
      }
      picture.setPoses(this.session.latest?.poses ?? []);
      picture.setGives(this.edits.displaced !== null || (this.session.latest?.matter.model ?? null) !== null);
      this.view.tell();
      this.touch.hand(picture, camera, this.view.viewport);
    }
    picture.advance(now);
    this.loader.follow(picture);
    this.sight.follow(picture.shown.finished);
  }

  /** Hands edits to the GPU as they come: all of one before anything is drawn again. */
  private takeEdits(): void {
    const { held } = this.loader;
    if (held !== null) {
      this.edits.show(held, this.picture);
    }
  }
}
