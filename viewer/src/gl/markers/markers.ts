/**
 * Probe, device point, the line between them, the force arrow, the contact with its normal
 * and the probe's recent way, in the scene [mm].
 *
 * Each is drawn twice: solid where nothing hides it, and as a faint ghost where bone or
 * tissue stands before it, so that the probe can always be found. Sizes follow the picture
 * [CSS pixels].
 */
import * as THREE from "three";
import { srgbFromHex } from "../../core/base/colour";
import type { ModelParticles } from "../../core/tissue/particles";
import type { PathTrail } from "../../core/touch/path_trail";
import { addScaled, distance, length, normalize, type Vec3 } from "../../core/geometry/vector";
import { ForceGauge } from "./force_gauge";
import { cone, cylinder, Marker, ring, usualGhost } from "./marker";
import { ParticleDots } from "./particle_dots";
import { PathRibbon } from "./path_ribbon";
import { around, sameTool, ToolShape, type ShownTool } from "./tool_shape";

/** What of touch is drawn beside probe, device and force. */
export interface Shown {
  /** Where the force comes from. */
  readonly contactPoint: boolean;
  /** Arrow out of the surface, and the plane it stands on. */
  readonly normal: boolean;
  /** The probe's ball at its true size. */
  readonly ball: boolean;
  /** The probe's way of the last seconds. */
  readonly path: boolean;
}

export interface MarkerState {
  readonly probe: Vec3;
  /** Of the probe's ball [mm]; 0 is a point. */
  readonly radius: number;
  readonly contactPoint: Vec3;
  /** Unit vector out of the surface; zero without contact. */
  readonly normal: Vec3;
  readonly trail: PathTrail;
  /** Nodes or particles of the model of deformation; null where they are not shown. */
  readonly parts: ModelParticles | null;
  readonly show: Shown;
  /** The tool in the hand; null without one. */
  readonly tool: ShownTool | null;
  readonly device: Vec3;
  /** [N] */
  readonly force: Vec3;
  readonly contact: boolean;
  /** Size of a CSS pixel at the probe [mm]. */
  readonly pixel: number;
  /** Force that fills the ring [N]. */
  readonly fullForce: number;
}

/** Length of the arrow for one newton, and at most [pixels]. */
const arrowPerNewton = 40;
const longestArrow = 160;
/** The probe, the dot where the force comes from, and the normal there [pixels]. */
const probeRadius = 6.5;
const dotRadius = 3.2;
const normalLength = 60;
const planeRadius = 13;

/** How far a marker reaches beyond its points [pixels]. */
export const markerMargin = 20;

const accent = srgbFromHex("#5cc8ff");
const pale = srgbFromHex("#dff3ff");
const amber = srgbFromHex("#ffb454");
const mint = srgbFromHex("#8ff0b5");

export class Markers {
  readonly scene = new THREE.Scene();
  private readonly probe = new Marker(new THREE.IcosahedronGeometry(1, 4), 1);
  private readonly device = new Marker(new THREE.IcosahedronGeometry(1, 3), 0.55);
  private readonly line = new Marker(cylinder(), 0.8);
  private readonly shaft = new Marker(cylinder(), 1);
  private readonly head = new Marker(cone(), 1);
  private readonly ball = new Marker(new THREE.IcosahedronGeometry(1, 5), 0.42, 0.55);
  private readonly tool = new ToolShape();
  private readonly dot = new Marker(new THREE.IcosahedronGeometry(1, 3), 1);
  private readonly plane = new Marker(ring(), 0.5, usualGhost, THREE.DoubleSide);
  private readonly normalShaft = new Marker(cylinder(), 1);
  private readonly normalHead = new Marker(cone(), 1);
  private readonly gauge = new ForceGauge(amber);
  private readonly path = new PathRibbon(accent);
  private readonly parts = new ParticleDots();

  private shown: MarkerState | null = null;
  private tip: Vec3 = [0, 0, 0];
  private normalTip: Vec3 = [0, 0, 0];

  constructor() {
    for (const marker of this.all) {
      this.scene.add(marker.group);
    }
    this.scene.add(this.tool.group, this.gauge.mesh, this.path.group, this.parts.group);
    this.device.paint(accent);
    this.line.paint(accent);
    this.shaft.paint(amber);
    this.head.paint(amber);
    for (const marker of [this.dot, this.plane, this.normalShaft, this.normalHead]) {
      marker.paint(mint);
    }
  }

  /** Shows another state; false where nobody could see the difference. */
  update(state: MarkerState): boolean {
    if (this.shown !== null && looksSame(this.shown, state)) {
      return false;
    }
    this.shown = state;
    this.showProbe(state);
    this.tool.update(state.probe, state.tool, state.pixel);
    this.showForce(state);
    this.showContact(state);
    this.parts.update(state.parts);
    this.path.group.visible = state.show.path;
    if (state.show.path) {
      this.path.update(state.trail, state.pixel);
    }
    return true;
  }

  /** Points of the scene whose surroundings, `markerMargin` wide, hold everything that is drawn. */
  get outline(): readonly Vec3[] {
    if (this.shown === null) {
      return [];
    }
    const { probe, device, radius, show, trail } = this.shown;
    const ball = around(probe, show.ball ? radius : 0);
    return [
      probe,
      device,
      this.tip,
      this.normalTip,
      ...ball,
      ...this.tool.outline,
      ...(show.path ? trail.points : []),
      ...this.parts.outline,
    ];
  }

  dispose(): void {
    for (const marker of this.all) {
      marker.dispose();
    }
    this.tool.dispose();
    this.gauge.dispose();
    this.path.dispose();
    this.parts.dispose();
  }

  private showProbe({ probe, device, contact, pixel, radius, show, tool }: MarkerState): void {
    // the tool's ball is what matters then: two balls cannot be told apart
    const ball = show.ball && radius > 0 && tool === null;
    const colour = contact ? pale : accent;
    this.ball.group.visible = ball;
    this.ball.paint(colour);
    this.ball.ball(probe, radius);
    this.probe.paint(colour);
    // inside of its ball the middle is only marked
    this.probe.ball(
      probe,
      ball ? Math.min(probeRadius * pixel, Math.max(2 * pixel, 0.4 * radius)) : probeRadius * pixel,
    );
    this.device.ball(device, 4.5 * pixel);
    this.line.span(probe, device, pixel);
    this.device.group.visible = distance(probe, device) > 1.5 * pixel;
  }

  private showForce({ probe, force, pixel, fullForce }: MarkerState): void {
    const newtons = length(force);
    const share = Math.min(1, newtons / fullForce);
    const arrow = pixel * Math.min(longestArrow, arrowPerNewton * newtons);
    const tip = addScaled(probe, normalize(force), arrow + 8 * pixel);
    this.tip = tip;
    const neck = addScaled(tip, normalize(force), -12 * pixel);
    const shown = newtons > 1e-3;
    this.shaft.span(probe, neck, 1.9 * pixel);
    this.head.span(neck, tip, 5.5 * pixel);
    this.shaft.group.visible &&= shown && distance(probe, neck) > probeRadius * pixel;
    this.head.group.visible &&= shown;
    this.gauge.update(probe, shown ? share : 0, pixel);
  }

  private showContact({ contactPoint, normal, contact, probe, pixel, show }: MarkerState): void {
    const touching = contact && length(normal) > 0.5;
    const up = normalize(normal);
    const neck = addScaled(contactPoint, up, (normalLength - 10) * pixel);
    const tip = addScaled(contactPoint, up, normalLength * pixel);
    this.normalShaft.span(contactPoint, neck, 1.1 * pixel);
    this.normalHead.span(neck, tip, 3.6 * pixel);
    this.plane.plate(contactPoint, up, planeRadius * pixel);
    this.dot.ball(contactPoint, dotRadius * pixel);
    this.plane.lift(2 * pixel);
    // in front of the probe's own ball, which the contact lies in or under
    this.dot.lift((probeRadius + 2) * pixel);
    for (const marker of [this.normalShaft, this.normalHead, this.plane]) {
      marker.group.visible = touching && show.normal;
    }
    this.dot.group.visible = touching && show.contactPoint;
    this.normalTip = touching && show.normal ? tip : probe;
  }

  private get all(): readonly Marker[] {
    const { ball, dot, plane, normalShaft, normalHead } = this;
    return [
      this.probe,
      this.device,
      this.line,
      this.shaft,
      this.head,
      ball,
      dot,
      plane,
      normalShaft,
      normalHead,
    ];
  }
}

/** Moves of less than a fifth of a pixel cannot be seen. */
function looksSame(a: MarkerState, b: MarkerState): boolean {
  const still = 0.2 * b.pixel;
  return (
    a.contact === b.contact &&
    a.pixel === b.pixel &&
    a.fullForce === b.fullForce &&
    distance(a.probe, b.probe) < still &&
    distance(a.device, b.device) < still &&
    distance(a.contactPoint, b.contactPoint) < still &&
    // half a degree
    distance(a.normal, b.normal) < 0.01 &&
    a.radius === b.radius &&
    sameTool(a.tool, b.tool) &&
    a.show === b.show &&
    a.parts === b.parts &&
    !(b.show.path && b.trail.alive) &&
    distance(a.force, b.force) < 0.002 * b.fullForce
  );
}
