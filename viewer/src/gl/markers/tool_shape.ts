/**
 * The tool in the hand: the ball of its tip, its shaft with the grip from there outward, and of a needle where it went
 * in and the way that it was planned to take. Scene [mm].
 */
import * as THREE from "three";
import { addScaled, distance, normalize, subtract, type Vec3 } from "../../core/geometry/vector";
import type { ToolLine } from "../../core/tools/tool_line";
import { srgbFromHex } from "../../core/base/colour";
import { cylinder, Marker, ring, usualGhost } from "./marker";

export interface ShownTool {
  /** Of its ball. */
  readonly radius: number;
  /** sRGB, 0..1. */
  readonly colour: Vec3;
  /** Null of a tool that is a ball alone. */
  readonly line: ToolLine | null;
}

const steel = srgbFromHex("#c3ccd6");
const grip = srgbFromHex("#8a97a6");
const white = srgbFromHex("#ffffff");
/** As marks are, which the plan is one of; theme.css. */
const planned = srgbFromHex("#ff9ad5");
/** A shaft is at least this thick on the screen, and the ring around the entry so large [pixels]. */
const thinnest = 1.4;
const entryRadius = 9;

export class ToolShape {
  readonly group = new THREE.Group();
  private readonly ball = new Marker(new THREE.IcosahedronGeometry(1, 5), 0.34, 0.6);
  private readonly shaft = new Marker(cylinder(), 1, 0.4);
  private readonly grip = new Marker(cylinder(), 1, 0.4);
  private readonly entry = new Marker(ring(), 0.95, 0.6, THREE.DoubleSide);
  private readonly plan = new Marker(cylinder(), 0.45, usualGhost + 0.3);
  private shown: readonly Vec3[] = [];

  constructor() {
    this.shaft.paint(steel);
    this.grip.paint(grip);
    this.entry.paint(white);
    this.plan.paint(planned);
    for (const { group } of this.all) {
      this.group.add(group);
    }
  }

  /** @param tip of the tool. @param pixel size of a CSS pixel there [mm]. */
  update(tip: Vec3, tool: ShownTool | null, pixel: number): void {
    this.group.visible = tool !== null;
    this.shown = [];
    if (tool === null) {
      return;
    }
    this.ball.paint(tool.colour);
    this.ball.ball(tip, tool.radius);
    const { line } = tool;
    for (const { group } of [this.shaft, this.grip, this.entry, this.plan]) {
      group.visible = line !== null;
    }
    this.shown = [...around(tip, tool.radius), ...(line === null ? [] : this.showLine(tip, line, pixel))];
  }

  /** Points around what is drawn. */
  get outline(): readonly Vec3[] {
    return this.shown;
  }

  dispose(): void {
    for (const marker of this.all) {
      marker.dispose();
    }
  }

  private showLine(tip: Vec3, line: ToolLine, pixel: number): readonly Vec3[] {
    const { axis, shaft, grip: held, entry, plan } = line;
    const thin = thinnest * pixel;
    const neck = addScaled(tip, axis, shaft.length);
    const end = addScaled(neck, axis, held.length);
    this.shaft.span(tip, neck, Math.max(thin, shaft.radius));
    this.grip.span(neck, end, Math.max(2.2 * thin, held.radius));
    this.entry.group.visible = entry !== null;
    this.plan.group.visible = plan !== null;
    if (entry !== null) {
      this.entry.plate(entry, axis, entryRadius * pixel);
      this.entry.lift(4 * pixel);
    }
    if (plan === null) {
      return [end];
    }
    const [target, from] = plan;
    const outside = addScaled(from, normalize(subtract(from, target)), shaft.length / 2);
    this.plan.span(target, outside, Math.max(1.6 * thin, 1.3 * shaft.radius));
    return [end, target, outside];
  }

  private get all(): readonly Marker[] {
    return [this.ball, this.shaft, this.grip, this.entry, this.plan];
  }
}

/** Whether nobody could see a difference: half a degree, a twentieth of a millimetre. */
export function sameTool(a: ShownTool | null, b: ShownTool | null): boolean {
  if (a === null || b === null) {
    return a === b;
  }
  const near = (one: Vec3 | null, other: Vec3 | null, apart: number): boolean =>
    one === null || other === null ? one === other : distance(one, other) < apart;
  return (
    a.radius === b.radius &&
    a.colour === b.colour &&
    near(a.line?.axis ?? null, b.line?.axis ?? null, 0.01) &&
    near(a.line?.entry ?? null, b.line?.entry ?? null, 0.05) &&
    a.line?.plan === b.line?.plan &&
    a.line?.shaft.length === b.line?.shaft.length
  );
}

/** Points that a ball reaches along the axes. */
export function around(centre: Vec3, radius: number): readonly Vec3[] {
  const axes: readonly Vec3[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  return axes.flatMap((axis) => [addScaled(centre, axis, radius), addScaled(centre, axis, -radius)]);
}
