/**
 * The pane of the 3-D view on the screen: what each eye sees of the scan, and over it marks and the markers of touch.
 */
import * as THREE from "three";
import { project, type Camera, type Extent } from "../../core/geometry/camera";
import { coarsest } from "../../core/view/draw_budget";
import type { Rect } from "../../core/view/picture_layout";
import type { Region } from "../../core/view/region";
import { eyeCamera, eyesOf, firstStereo, viewportOf, type Stereo } from "../../core/view/stereo";
import type { Vec3 } from "../../core/geometry/vector";
import { Anaglyph } from "./anaglyph";
import { Compositor, type Composition } from "./compositor";
import type { ScreenPane } from "./upscaler";
import type { CutSheet } from "../../core/segments/cut_sheet";
import { CutSheetShape, outlineOf } from "../markers/cut_sheet";
import { MarkStrokes } from "../markers/mark_strokes";
import { markerMargin, Markers, type MarkerState } from "../markers/markers";
import type { PictureTarget } from "../base/picture_target";
import { ThreeCamera } from "../base/three_camera";

/** A pixel of the coarsest picture fades this far into its background, and markers reach less far [CSS pixels]. */
const pictureMargin = 2 * coarsest;

export class ViewPane {
  stereo: Stereo = firstStereo;
  /** The pane, and the height of the canvas that it is a part of [CSS pixels from the upper left]. */
  rect: Rect = { x: 0, y: 0, width: 1, height: 1 };
  canvasHeight = 1;
  /** Markers stand elsewhere than they were drawn. */
  stale = true;
  /** What is on display, as seen from between the eyes. */
  private shownCamera: Camera | null = null;
  private readonly cameras = [new ThreeCamera(), new ThreeCamera()] as const;
  private readonly anaglyph = new Anaglyph();
  private readonly marks = new MarkStrokes();
  private readonly markers = new Markers();
  private readonly sheet = new CutSheetShape();
  private markersShown = false;
  /** Where markers were drawn last [CSS pixels from the upper left of the pane]; null where that could be anywhere. */
  private marked: THREE.Box2 | null = null;
  /** The same of all that stood before the background. */
  private filled: THREE.Box2 | null = null;
  /** Where the background was drawn with a coarse picture. */
  private readonly coarse = new THREE.Box2();
  /** Of all marks, and of a cut; scene [mm]. */
  private markedPoints: readonly Vec3[] = [];
  private sheetPoints: readonly Vec3[] = [];
  /** Marks or a cut stand elsewhere than they were drawn. */
  private marksStale = false;
  private bare = false;

  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly compositor: Compositor,
    /** The cached picture of an eye. */
    private readonly pictureOf: (eye: number) => PictureTarget,
  ) {}

  /** The picture is of this view from now on, and so are marks and markers. */
  look(camera: Camera, extent: Extent): void {
    const { rect, stereo } = this;
    const { width, height } = viewportOf(stereo, rect);
    this.shownCamera = camera;
    eyesOf(stereo, rect).forEach(({ aside }, eye) => {
      this.cameraOf(eye).update(eyeCamera(camera, aside), extent, width / height);
    });
  }

  /** What covers points of the scene in the picture on display; null where that cannot be told. */
  regionOf(points: readonly Vec3[]): Region | null {
    const box = this.boxAround(points, 0);
    const { width, height } = this.rect;
    return box === null ? null : [box.min.x / width, 1 - box.max.y / height, box.max.x / width, 1 - box.min.y / height];
  }

  /** The picture is enlarged on the screen. */
  get isCoarse(): boolean {
    return Compositor.isCoarse(this.pictureOf(0));
  }

  setStereo(stereo: Stereo): void {
    this.stereo = stereo;
    this.anaglyph.forget();
  }

  /** Points of each mark, in their order; scene [mm]. */
  setMarks(lines: readonly (readonly Vec3[])[]): void {
    this.marks.show(lines);
    this.markedPoints = lines.flat();
    this.marksStale = true;
    this.stale = true;
  }

  /** The surface that a cut would go along; null where nothing is cut. */
  setCutSheet(sheet: CutSheet | null): void {
    this.sheet.show(sheet);
    this.sheetPoints = outlineOf(sheet);
    this.marksStale = true;
    this.stale = true;
  }

  setMarkers(state: MarkerState): void {
    this.stale = this.markers.update(state) || this.stale;
    this.markersShown = true;
  }

  /**
   * Draws all of it, or where the background is seen before and after only the rest.
   *
   * @param outline points around all that is drawn of the scan [scene, mm]; null where the screen forgets, or that may
   * be anywhere.
   */
  draw(outline: readonly Vec3[] | null): void {
    const { filled: before } = this;
    const now =
      outline === null
        ? null
        : this.boxAround([...outline, ...this.over], pictureMargin);
    this.drawPart(
      before === null || now === null
        ? null
        : now
            .clone()
            .union(before)
            .union(this.isCoarse ? now : this.coarse),
    );
    this.filled = now;
  }

  /** Draws what is seen of the scan, without anything over it. */
  drawPicture(): void {
    this.bare = true;
    this.drawPart(null);
    this.bare = false;
  }

  /** Draws again where markers were and are, and a region of the picture; all of it where the screen forgets. */
  drawMarkers(keepsScreen: boolean, region: Region | null): void {
    const before = this.marked;
    const now = this.boxAround(this.markers.outline, markerMargin);
    const box = before !== null && now !== null ? now.clone().union(before) : null;
    if (region !== null) {
      box?.union(this.boxOf(region));
    }
    this.drawPart(keepsScreen && !this.marksStale ? box : null);
    const over = this.boxAround(this.over, markerMargin);
    this.filled = over === null ? null : (this.filled?.union(over) ?? null);
  }

  /** Draws marks alone, into what is drawn into now. @param height of what the camera sees [CSS pixels]. */
  drawMarks(camera: THREE.Camera, height: number): void {
    this.marks.draw(this.renderer, camera, height);
  }

  dispose(): void {
    this.anaglyph.dispose();
    this.marks.dispose();
    this.sheet.dispose();
    this.markers.dispose();
  }

  /** Points around all that is drawn over the picture. */
  private get over(): readonly Vec3[] {
    return [...this.markedPoints, ...this.sheetPoints, ...this.markers.outline];
  }

  private cameraOf(eye: number): ThreeCamera {
    return this.cameras[eye === 0 ? 0 : 1];
  }

  private drawPart(part: THREE.Box2 | null): void {
    const { rect: pane, renderer, stereo } = this;
    renderer.setScissorTest(true);
    if (stereo.mode === "anaglyph") {
      this.drawMixed();
    } else {
      eyesOf(stereo, pane).forEach(({ rect }, eye) => {
        this.drawEye(eye, { pane: this.enter({ ...rect, x: pane.x + rect.x, y: pane.y + rect.y }, part) });
      });
    }
    renderer.setScissorTest(false);
    if (this.isCoarse) {
      this.coarse.union(part ?? new THREE.Box2(new THREE.Vector2(), new THREE.Vector2(pane.width, pane.height)));
    } else if (part?.containsBox(this.coarse) !== false) {
      this.coarse.makeEmpty();
    }
    this.marked = this.boxAround(this.markers.outline, markerMargin);
    this.stale = false;
    this.marksStale = false;
  }

  private drawEye(eye: number, where: Composition): void {
    const { camera } = this.cameraOf(eye);
    this.compositor.draw(this.renderer, this.pictureOf(eye), where);
    if (this.bare) {
      return;
    }
    this.sheet.draw(this.renderer, camera);
    this.marks.draw(this.renderer, camera, viewportOf(this.stereo, this.rect).height);
    if (this.markersShown) {
      this.renderer.render(this.markers.scene, camera);
    }
  }

  /** Draws what both eyes see beside the screen, and the mixture of both onto it. */
  private drawMixed(): void {
    const { width, height } = this.pictureOf(0).target;
    this.anaglyph.resize(width, height);
    this.anaglyph.eyes.forEach((into, eye) => {
      this.drawEye(eye, { pane: { corner: [0, 0], size: [width, height] }, into });
    });
    this.renderer.setRenderTarget(null);
    this.anaglyph.draw(this.renderer, this.enter(this.rect, null).corner);
  }

  /** Restricts drawing to a pane, or to a part of it; returns the pane. */
  private enter({ x, y: top, width, height }: Rect, part: THREE.Box2 | null): ScreenPane {
    const { renderer } = this;
    const y = this.canvasHeight - top - height;
    const inside = new THREE.Box2(new THREE.Vector2(), new THREE.Vector2(width, height));
    const box = part === null ? inside : part.clone().intersect(inside);
    const size = box.getSize(new THREE.Vector2());
    renderer.setScissor(x + box.min.x, y + height - box.max.y, size.x, size.y);
    renderer.setViewport(x, y, width, height);
    const ratio = renderer.getPixelRatio();
    return { corner: [x * ratio, y * ratio], size: [Math.floor(width * ratio), Math.floor(height * ratio)] };
  }

  /** A region of the picture as a box [CSS pixels from the upper left of the pane]. */
  private boxOf([left, lower, right, upper]: Region): THREE.Box2 {
    const { width, height } = this.rect;
    return new THREE.Box2(
      new THREE.Vector2(left * width, (1 - upper) * height),
      new THREE.Vector2(right * width, (1 - lower) * height),
    );
  }

  /** Box around points of the scene; null where it cannot be told, or where each is drawn twice. */
  private boxAround(points: readonly Vec3[], margin: number): THREE.Box2 | null {
    if (this.stereo.mode !== "off") {
      return null;
    }
    const box = new THREE.Box2();
    for (const point of points) {
      const place = this.shownCamera === null ? null : project(this.shownCamera, point, this.rect);
      if (place === null) {
        return null;
      }
      box.expandByPoint(new THREE.Vector2(...place));
    }
    return box.isEmpty() ? null : box.expandByScalar(margin);
  }
}
