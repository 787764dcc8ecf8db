/**
 * A cut along a painted line: from the wish to cut a segment, through the line that is painted and
 * what the engine says of its parts, to the cut.
 */
import { pixelSizeAt, type Camera, type Viewport } from "../../../core/geometry/camera";
import { cutSheet, type CutSheet } from "../../../core/segments/cut_sheet";
import { cornersOf, unmoved } from "../../../core/geometry/object_pose";
import { transformPoint } from "../../../core/geometry/affine";
import { frameOf } from "../../../core/scan/scan_volume";
import type { CutPreview, Segment } from "../../../core/protocol";
import { addScaled, type Vec3 } from "../../../core/geometry/vector";
import type { Session } from "../../state/session.svelte";
import { PaintedLine } from "./painted_line.svelte";

/** Half of the line that is proposed: the engine carries it on [CSS pixels]. */
const proposed = 40;

export class CutControl extends PaintedLine {
  /** The segment that is to be cut; null where none is. */
  id = $state.raw<number | null>(null);

  /** @param begins ends what else waits for a line. */
  constructor(
    private readonly session: Session,
    private readonly begins: () => void,
  ) {
    super();
  }

  get armed(): boolean {
    return this.segment !== null;
  }

  /** The segment that is to be cut, as long as it is there. */
  get segment(): Segment | null {
    return this.session.segments.find(({ id }) => id === this.id) ?? null;
  }

  /** What the engine says of the line's parts; null before it has. */
  get parts(): CutPreview | null {
    const { cutPreview } = this.session;
    return this.line !== null && cutPreview?.id === this.id ? cutPreview : null;
  }

  /** Whether there is a line that parts the segment. */
  get ready(): boolean {
    return this.parts !== null && this.parts.smaller_ml !== null;
  }

  /** Whether the left button paints: a line that parts the segment is looked at from all sides first. */
  override get paints(): boolean {
    return this.armed && (this.line === null || (this.parts !== null && !this.ready));
  }

  /** The surface that would be cut along; null before there is a line. */
  override get sheet(): CutSheet | null {
    return this.shownSheet;
  }

  private readonly shownSheet = $derived.by((): CutSheet | null => {
    const { line, segment } = this;
    const { scan } = this.session;
    if (line === null || segment === null || scan === null || segment.bounds === null) {
      return null;
    }
    const pose = segment.pose ?? unmoved;
    const corners = cornersOf(segment, frameOf(scan).sceneFromGrid).map((corner) => transformPoint(pose, corner));
    return cutSheet(line, corners);
  });

  /** Waits for a line over a segment. */
  start(id: number): void {
    this.cancel();
    this.begins();
    this.id = id;
  }

  /** Proposes the plane through a point that is upright in the picture and seen from its edge. */
  propose(id: number, point: Vec3, camera: Camera, viewport: Viewport): void {
    this.start(id);
    const half = proposed * pixelSizeAt(camera, point, viewport);
    const points = [addScaled(point, camera.up, half), addScaled(point, camera.up, -half)];
    this.see({ points, closed: false }, camera);
  }

  /** Has another line painted in place of this one. */
  paintAnew(): void {
    this.forget();
  }

  cancel(): void {
    this.id = null;
    this.painting = null;
    this.forget();
  }

  /** Cuts along the line. */
  cut(): void {
    if (this.ready) {
      this.send(false);
      this.cancel();
    }
  }

  protected override ask(): void {
    this.send(true);
  }

  protected override forget(): void {
    super.forget();
    this.session.cutPreview = null;
  }

  private send(preview: boolean): void {
    const { id, line } = this;
    if (id !== null && line !== null) {
      const { points, eye, view, closed } = line;
      this.session.send({ type: "cut_along", id, line: points, eye, view, closed, preview });
    }
  }
}
