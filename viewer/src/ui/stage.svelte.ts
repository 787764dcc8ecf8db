/**
 * What stands on the stage: the scan, the camera and the picture, and the loop that draws.
 * Joins the engine's state (`Session`) with the GPU (`Picture`).
 */
import { transformPoint } from "../core/affine";
import type { Letter } from "../core/anatomy";
import type { BrickRanges } from "../core/bricks";
import {
  extentOf,
  firstView,
  frame,
  inProjection,
  lookFrom,
  pixelSizeAt,
  rayThrough,
  reshaped,
  sameView,
  type Camera,
  type Extent,
  type Ray,
  type Viewport,
} from "../core/camera";
import { srgbFromHex } from "../core/colour";
import { contentHull } from "../core/content_hull";
import type { Look } from "../core/look";
import { PathTrail } from "../core/path_trail";
import { valueInVoxel } from "../core/field";
import type { Panes } from "../core/picture_layout";
import type { Fusion } from "../core/second_scan";
import { unmoved } from "../core/object_pose";
import { surfaceCrossings } from "../core/pick_patches";
import { pickSurface, type Picked } from "../core/pick_surface";
import type { Scan, Segment, State } from "../core/protocol";
import { frameOf, type ScanVolume } from "../core/scan_volume";
import { drawnAsSurface, drawnFromVoxels, drawnKey, LastRanges, rangesInside, showable, shownRanges } from "../core/shown_segments";
import { toolColours } from "../core/tools";
import { biasedRange } from "../core/stored_values";
import { previewStep, subsamplingStep } from "../core/subsampling";
import { Unchanged } from "../core/unchanged";
import type { Vec3 } from "../core/vector";
import type { GpuSupport } from "../gl/gpu_support";
import type { Shown, ToolBall } from "../gl/markers";
import { Picture } from "../gl/picture";
import type { SnapshotWish } from "../gl/snapshot";
import { downloadLabels, downloadVolume } from "../live/volume_download";
import { BrushControl } from "./brush_control.svelte";
import { ClipControl } from "./clip_control.svelte";
import { EditPaceControl } from "./edit_pace_control.svelte";
import { GrowControl } from "./grow_control.svelte";
import { HandedViews } from "./handed_views";
import { LookControl } from "./look_control.svelte";
import { PageSteps } from "./page_steps.svelte";
import { Player, type ShownTouch } from "./player.svelte";
import { ReadOut } from "./read_out.svelte";
import { RegistrationControl } from "./registration_control.svelte";
import { recall, remember } from "./remembered";
import type { Session } from "./session.svelte";
import { SecondControl } from "./second_control.svelte";
import { SliceControl } from "./slice_control.svelte";
import { CutControl } from "./cut_control.svelte";
import { MarkControl } from "./mark_control.svelte";
import { ObjectControl } from "./object_control.svelte";
import { needsLabels, ShownEdits } from "./shown_edits.svelte";
import { StereoControl } from "./stereo_control.svelte";

/** Most values of a scan that are taken to the GPU: 1 GiB in 16 bit. */
const mostValues = 2 ** 29;

/** How long the probe's way is shown [s], in at most how many points, how far apart [mm]. */
const trailSeconds = 4;
const trailPoints = 400;
const trailSpacing = 0.1;

export class Stage {
  camera = $state.raw<Camera | null>(null);
  /** Size of what is seen in the 3-D view's pane, by each eye where there are two [CSS pixels]. */
  viewport = $state.raw<Viewport>({ width: 1, height: 1 });
  /** The slices beside it. */
  readonly slices = new SliceControl(() => this.camera);
  /** What each eye sees of the 3-D view. */
  readonly stereo = new StereoControl(() => this.camera, () => this.slices.panes.view);
  /** How the scan is shown. */
  readonly looks = new LookControl();
  /** What of the 3-D view is cut away. */
  readonly clips: ClipControl;
  /** Range of a segment while its slider is dragged, before the engine is asked. */
  preview = $state.raw<{ readonly id: number; readonly range: readonly [number, number] } | null>(null);
  /** Share of the scan on its way to the picture, 0..1; null once it is shown. */
  progress = $state.raw<number | null>(0);
  /** What a person should know of a scan that is too large for the GPU. */
  coarseness = $state.raw<string | null>(null);
  /** Why the scan cannot be shown. */
  failure = $state.raw<string | null>(null);
  /** What of touch is drawn beside probe, device and force. */
  shown = $state.raw<Shown>({ contactPoint: true, normal: true, ball: true, path: true });
  /** Edits of the voxels, and the surfaces of segments. */
  readonly edits: ShownEdits;
  /** How often the picture follows them. */
  readonly editPace: EditPaceControl;
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
  readonly readOut = new ReadOut();
  /** A second scan that is shown with the first. */
  readonly second: SecondControl;
  /** How it is brought to the first. */
  readonly registration: RegistrationControl;
  /** Steps of marks, clipping and registration, in their order. */
  readonly steps: PageSteps;
  /** Points, distances and angles that a person has set. */
  readonly marks: MarkControl;
  framesPerSecond = $state.raw(0);
  /** When the first picture stood on the screen, of a large scan a coarse one [ms since the page was opened]. */
  firstPicture = $state.raw<number | null>(null);
  /** When that of all of the scan did. */
  wholePicture = $state.raw<number | null>(null);
  /** A coarse picture stands for the scan that is on its way. */
  previewed = $state.raw(false);

  drawingSuspended = false;

  private picture: Picture | null = null;
  private canvas: HTMLCanvasElement | null = null;
  private volume: ScanVolume | null = null;
  private bricks: BrickRanges | null = null;
  private extent: Extent | null = null;
  private drawnCamera: Camera | null = null;
  private readonly handed: HandedViews;
  private sentCamera: Camera | null = null;
  private sentTo = 0;
  private drawnState: object | null = null;
  private readonly lastRanges = new LastRanges();
  private readonly sameSegments = new Unchanged<readonly Segment[]>();
  private readonly sameLook = new Unchanged<Look>();
  private readonly trail = new PathTrail(trailSeconds, trailPoints, trailSpacing);
  private frames = 0;
  private countedAt = 0;
  private request = 0;
  /** Called once the coarse picture stands on the screen. */
  private previewShown: (() => void) | null = null;
  /** The view of it, unless a person turns it. */
  private previewCamera: Camera | null = null;

  constructor(
    private readonly session: Session,
    private readonly support: GpuSupport,
    private readonly token: string,
  ) {
    // a long line is dear to draw again and again without a graphics card
    this.shown = recall("shown", { ...this.shown, path: !support.software });
    this.objects = new ObjectControl(session);
    this.editPace = new EditPaceControl(session);
    this.cutting = new CutControl(session);
    this.growing = new GrowControl(session);
    this.brush = new BrushControl(session);
    this.steps = new PageSteps(() => session.latest?.edit ?? 0);
    this.clips = new ClipControl(this.steps);
    this.marks = new MarkControl(this.steps);
    this.player = new Player(session);
    this.second = new SecondControl({
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
    this.handed = new HandedViews(this, support.software);
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
        this.trail.add(state.time, state.proxy);
        this.slices.follow(state.proxy);
      }
    });
  }

  /** Takes the slices and the line of the way along with a scenario's tool. */
  followPlayed({ time, proxy }: ShownTouch): void {
    this.trail.add(time, proxy);
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

  /** Shows or hides some of what is drawn of touch. */
  mark(part: Partial<Shown>): void {
    this.shown = { ...this.shown, ...part };
    remember("shown", this.shown);
    this.drawnState = null;
  }

  /** Takes a canvas and draws on it until the returned function is called. */
  attach(canvas: HTMLCanvasElement): () => void {
    this.canvas = canvas;
    this.startPicture();
    const observer = new ResizeObserver(() => {
      this.fit();
    });
    observer.observe(canvas);
    const lost = (event: Event): void => {
      // the browser gives the graphics back; until then the last picture stays
      event.preventDefault();
      this.picture?.dispose();
      this.picture = null;
    };
    const restored = (): void => {
      this.startPicture();
    };
    canvas.addEventListener("webglcontextlost", lost);
    canvas.addEventListener("webglcontextrestored", restored);

    let running = true;
    const loop = (now: number): void => {
      if (running) {
        this.drawFrame(now);
        requestAnimationFrame(loop);
      }
    };
    requestAnimationFrame(loop);
    return () => {
      running = false;
      observer.disconnect();
      canvas.removeEventListener("webglcontextlost", lost);
      canvas.removeEventListener("webglcontextrestored", restored);
      this.picture?.dispose();
      this.picture = null;
    };
  }

  /** Downloads a scan and shows it. */
  async open(scan: Scan): Promise<void> {
    const request = ++this.request;
    const scanFrame = frameOf(scan);
    this.progress = 0;
    this.failure = null;
    // edits that arrive from now on are for this scan: they wait for it
    this.volume = null;
    this.bricks = null;
    this.edits.clear();
    const step = subsamplingStep(scanFrame.dimensions, { edge: this.support.largestEdge, values: mostValues });
    this.tellCoarseness(step);
    this.steps.clear();
    this.looks.open(scan);
    this.clips.open(scan.name, scanFrame);
    this.slices.open(scan);
    this.brush.open(scan);
    this.marks.open(scan);
    this.readOut.close();
    try {
      await this.showCoarsely(scan, step, request);
      if (request !== this.request) {
        return;
      }
      const { volume, bricks } = await downloadVolume(scanFrame, step, this.token, (share) => {
        this.progress = request === this.request ? 0.9 * share : this.progress;
      });
      if (request === this.request) {
        this.show(volume, bricks, scan);
      }
    } catch (error) {
      if (request === this.request) {
        this.failure = messageOf(error);
      }
    }
  }

  /** Shows a large scan coarsely while all of it is on its way; what else the page does waits for that. */
  private async showCoarsely(scan: Scan, step: number, request: number): Promise<void> {
    this.previewed = false;
    this.previewCamera = null;
    const scanFrame = frameOf(scan);
    const coarse = previewStep(scanFrame.dimensions, step);
    // what is not seen is not drawn
    if (coarse === null || document.hidden) {
      return;
    }
    const { volume, bricks } = await downloadVolume(scanFrame, coarse, this.token, () => undefined);
    const { picture, look } = this;
    if (request !== this.request || picture === null || look === null) {
      return;
    }
    this.measure(volume, bricks, scan);
    this.resetView();
    this.previewCamera = this.camera;
    picture.setScan(volume, bricks);
    picture.setLook(look);
    picture.setSegments(this.segments, this.looks.inside);
    await new Promise<void>((shown) => {
      this.previewShown = shown;
    });
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
    if (this.volume !== null) {
      const key = needsLabels(segments) ? version : null;
      void this.edits.showLabels(key, this.volume, () => this.picture);
    }
  }

  /** The look that the page's controls ask for; null before there is a scan. */
  readonly look = $derived.by((): Look | null => {
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
  applyLook(look: Look | null): void {
    if (look !== null && this.volume !== null) {
      this.picture?.setLook(look);
    }
  }

  /** Value of the scan at a point of the scene; null outside of it and before it is here. */
  valueAt(point: Vec3): number | null {
    const { volume } = this;
    return volume === null ? null : valueInVoxel(volume, transformPoint(volume.frame.gridFromScene, point));
  }

  /** Whether the CPU draws. */
  get software(): boolean {
    return this.support.software;
  }

  /** Size of what is shown; null before there is a scan. */
  get content(): Extent | null {
    return this.extent;
  }

  lookFrom(letter: Letter): void {
    this.camera = this.extent && this.projected(lookFrom(letter, this.extent, this.viewport), this.extent);
  }

  resetView(): void {
    this.camera = this.extent && this.projected(firstView(this.extent, this.viewport), this.extent);
  }

  /** Whether things look as large however far away they are. */
  get orthographic(): boolean {
    return this.camera === null ? recall("projection", { orthographic: false }).orthographic : this.camera.parallel !== null;
  }

  set orthographic(on: boolean) {
    remember("projection", { orthographic: on });
    this.camera = this.extent && this.camera && inProjection(this.camera, on, this.extent);
  }

  /** A view of all in the projection that was chosen. */
  private projected(camera: Camera, extent: Extent): Camera {
    return this.orthographic ? frame(inProjection(camera, true, extent), extent, this.viewport) : camera;
  }

  /** Moves the picture so that the probe is in its middle. */
  centreOnProbe(): void {
    const { latest } = this.session;
    this.camera = latest && this.camera && { ...this.camera, target: latest.proxy };
  }

  frameAll(): void {
    this.camera = this.extent && this.camera && frame(this.camera, this.extent, this.viewport);
  }

  /** What stands at a place of the 3-D view's pane [CSS pixels]: seen by the eye that is pointed with. */
  pick(x: number, y: number): Picked | null {
    const eye = this.stereo.at(x, y);
    return eye && this.pickAlong(rayThrough(eye.camera, ...eye.place, eye.viewport));
  }

  /** What a ray of the scene meets first. */
  pickAlong(ray: Ray): Picked | null {
    const { volume, look, segments, edits } = this;
    if (volume === null || look === null) {
      return null;
    }
    const poses = this.session.latest?.poses ?? [];
    const surfaces = segments.filter(drawnAsSurface).map(({ id, pose, opacity }) => ({
      id,
      // where it stands by now; its list has where it was asked to go
      pose: poses.find((moved) => moved.id === id)?.pose ?? pose ?? unmoved,
      opacity,
      patches: edits.patches(id),
    }));
    const labelAt = (grid: Vec3): { readonly id: number; readonly visible: boolean } | null => {
      const label = edits.labelAt(grid, volume.step);
      const segment = segments.find(({ id, range }) => id === label && range === null);
      const solid = segment !== undefined && (this.looks.inside[label] ?? "solid") === "solid";
      return segment === undefined || (!solid && drawnFromVoxels(segment)) ? null : { id: label, visible: drawnFromVoxels(segment) };
    };
    // an edited threshold is where its labels are
    const ranges = look.ranges.filter((range) => range.label === 0 && range.tinted !== true);
    return pickSurface(volume, { ...look, ranges }, ray, { crossings: surfaceCrossings(surfaces, ray), labelAt, clip: this.clips.cutting });
  }

  /** The segment that a voxel of the scan belongs to; one that is visible before others. */
  segmentAt(point: Vec3): Segment | null {
    const { volume, segments } = this;
    if (volume === null) {
      return null;
    }
    const label = this.edits.labelAt(transformPoint(volume.frame.gridFromScene, point), volume.step);
    const value = this.valueAt(point) ?? NaN;
    const held = segments.filter(
      ({ id, range, pose, grid }) =>
        pose === null && grid === null && (range === null ? id === label : range[0] <= value && value <= range[1]),
    );
    return held.find(({ visible }) => visible) ?? held[0] ?? null;
  }

  /** Draws a view into a canvas. */
  async snapshot(context: CanvasRenderingContext2D, wish: SnapshotWish): Promise<void> {
    if (this.picture === null) {
      throw new Error("there is no picture");
    }
    await this.picture.snapshot(context, wish);
  }

  /** What is drawn, and the scan as the page holds it; for benchmarks. */
  get drawn(): Picture | null {
    return this.picture;
  }

  get held(): ScanVolume | null {
    return this.volume;
  }

  /** How fine the picture on display is. */
  get quality(): Picture["quality"] | null {
    const { handed, picture } = this;
    return picture && { ...picture.quality, finished: picture.quality.finished && handed.isWhole };
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

  private tellCoarseness(step: number): void {
    const resolution = `1/${String(step)} of its resolution`;
    this.coarseness = step === 1 ? null : `Too large for this GPU: shown at ${resolution}; touch uses all of it.`;
    if (this.coarseness !== null) {
      this.session.notify("warning", this.coarseness);
    }
  }

  private show(volume: ScanVolume, bricks: BrickRanges, scan: Scan): void {
    this.volume = volume;
    this.bricks = bricks;
    this.measure(volume, bricks, scan);
    if (this.previewCamera === null || this.camera === this.previewCamera) {
      this.resetView();
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
    this.extent = extentOf(hull.map((point) => transformPoint(scanFrame.sceneFromGrid, point)));
  }

  /** Makes the picture, also anew after the graphics were reset. */
  private startPicture(): void {
    if (this.canvas === null) {
      return;
    }
    this.picture?.dispose();
    this.picture = null;
    this.endPreview();
    try {
      this.picture = new Picture(this.canvas, { support: this.support, mostPixelRatio: this.support.software ? 1 : 2 });
    } catch (error) {
      this.failure = `the graphics did not start: ${messageOf(error)}`;
      return;
    }
    this.drawnCamera = null;
    this.handed.forget();
    this.drawnState = null;
    this.fit();
    this.fillPicture();
  }

  /** Hands everything that the page holds to a new picture, or a new scan to the picture. */
  private fillPicture(): void {
    const { picture, volume, bricks } = this;
    if (picture !== null && volume !== null && bricks !== null) {
      picture.setScan(volume, bricks);
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
    const { width, height } = this.stereo.viewport(view);
    const before = this.viewport;
    if (width !== before.width || height !== before.height) {
      this.viewport = { width, height };
      this.camera = this.camera && reshaped(this.camera, before, this.viewport);
    }
    this.picture?.setStereo(this.stereo.choice);
    this.picture?.resize(size.width, size.height, view);
    this.drawnState = null;
  }

  private drawFrame(now: number): void {
    this.count(now);
    const { camera, extent, picture } = this;
    this.takeEdits();
    this.editPace.begin(now, this.edits.lastEdit);
    if (picture === null) {
      return;
    }
    this.handed.hand(picture, now, this.volume !== null);
    if (camera !== null && extent !== null) {
      if (camera !== this.drawnCamera) {
        picture.setCamera(camera, extent);
        this.drawnCamera = camera;
        this.drawnState = null;
      }
      picture.setPoses(this.session.latest?.poses ?? []);
      picture.setGives(this.edits.displaced !== null || (this.session.latest?.matter.model ?? null) !== null);
      this.sendView(camera);
      this.moveMarkers(camera, picture);
    }
    picture.advance(now);
    this.followUpload(picture);
  }

  /** Hands edits to the GPU as they come: all of one before anything is drawn again. */
  private takeEdits(): void {
    const { volume, bricks } = this;
    if (volume !== null && bricks !== null) {
      this.edits.show({ volume, bricks }, this.picture);
    }
  }

  private moveMarkers(camera: Camera, picture: Picture): void {
    const { latest } = this.session;
    const state: ShownTouch | null = this.player.shown ?? latest;
    if (latest === null || state === null || state === this.drawnState) {
      return;
    }
    this.drawnState = state;
    picture.setMarkers({
      probe: state.proxy,
      radius: state.probe_radius,
      contactPoint: state.contact_point,
      normal: state.normal,
      trail: this.trail,
      parts: this.session.parts,
      show: this.shown,
      tool: this.player.showing ? null : toolBall(latest),
      device: state.device,
      force: state.force,
      contact: state.contact,
      pixel: pixelSizeAt(camera, state.proxy, this.viewport),
      fullForce: this.session.settings?.force_limit ?? 4,
    });
  }

  /** Device moves follow the view's axes, so the engine must know them. */
  private sendView(camera: Camera): void {
    const { greetings } = this.session;
    if (this.sentCamera === null || this.sentTo !== greetings || !sameView(camera, this.sentCamera)) {
      this.sentCamera = camera;
      this.sentTo = greetings;
      this.session.send({ type: "view", right: camera.right, up: camera.up });
    }
  }

  /** What waits for the coarse picture goes on. */
  private endPreview(): void {
    this.previewShown?.();
    this.previewShown = null;
  }

  private followUpload(picture: Picture): void {
    if (this.previewShown !== null && picture.hasPicture) {
      this.firstPicture ??= performance.now();
      this.previewed = true;
      this.endPreview();
    }
    if (this.progress === null || this.volume === null) {
      return;
    }
    this.progress = 0.9 + 0.1 * picture.uploaded;
    if (picture.hasPicture) {
      this.progress = null;
      this.previewed = false;
      this.wholePicture ??= performance.now();
      this.firstPicture ??= this.wholePicture;
    }
  }

  private count(now: number): void {
    this.frames += 1;
    if (now - this.countedAt >= 1000) {
      this.framesPerSecond = Math.round((1000 * this.frames) / (now - this.countedAt));
      this.frames = 0;
      this.countedAt = now;
    }
  }
}

const toolPaints = {
  eraser: srgbFromHex(toolColours.eraser),
  adder: srgbFromHex(toolColours.adder),
  painter: srgbFromHex(toolColours.painter),
  drill: srgbFromHex(toolColours.drill),
  needle: srgbFromHex(toolColours.needle),
} as const;

function toolBall({ tool }: State): ToolBall | null {
  return tool.kind === "none" ? null : { radius: tool.radius, colour: toolPaints[tool.kind] };
}

function messageOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
