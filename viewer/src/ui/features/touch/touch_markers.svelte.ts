/**
 * What of touch stands in the picture: probe, device and force, and beside them what a person wants to see.
 */
import { pixelSizeAt, type Camera, type Viewport } from "../../../core/geometry/camera";
import { srgbFromHex } from "../../../core/base/colour";
import { PathTrail } from "../../../core/touch/path_trail";
import type { State } from "../../../core/protocol";
import { toolColours } from "../../../core/tools/tools";
import type { NeedlePlan } from "../../../core/tools/needle_plan";
import { toolLine } from "../../../core/tools/tool_line";
import type { Vec3 } from "../../../core/geometry/vector";
import type { Shown } from "../../../gl/markers/markers";
import type { ShownTool } from "../../../gl/markers/tool_shape";
import type { Picture } from "../../../gl/picture/picture";
import type { ShownTouch } from "../../../core/touch/shown_touch";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";

/** How long the probe's way is shown [s], in at most how many points, how far apart [mm]. */
const trailSeconds = 4;
const trailPoints = 400;
const trailSpacing = 0.1;

/** A recorded run that may be played in place of what is felt now. */
interface Played {
  /** Whether its tool is shown, and not the probe. */
  readonly showing: boolean;
  readonly shown: ShownTouch | null;
}

export class TouchMarkers {
  /** What is drawn beside probe, device and force. */
  shown = $state.raw<Shown>({ contactPoint: true, normal: true, ball: true, path: true });

  private readonly trail = new PathTrail(trailSeconds, trailPoints, trailSpacing);
  private drawn: object | null = null;

  /** @param software whether the CPU draws: a long line is dear to draw again and again then. */
  constructor(
    private readonly session: Session,
    private readonly held: { readonly player: Played; readonly needle: { readonly plan: NeedlePlan | null } },
    software: boolean,
  ) {
    this.shown = recall("shown", { ...this.shown, path: !software });
  }

  /** Shows or hides some of it. */
  change(part: Partial<Shown>): void {
    this.shown = { ...this.shown, ...part };
    remember("shown", this.shown);
    this.redraw();
  }

  /** Lengthens the probe's way. */
  add(time: number, point: Vec3): void {
    this.trail.add(time, point);
  }

  /** The picture needs all of it again. */
  redraw(): void {
    this.drawn = null;
  }

  /** Moves what is drawn to where it is by now. */
  pass(picture: Picture, camera: Camera, viewport: Viewport): void {
    const { latest, parts, settings } = this.session;
    const state: ShownTouch | null = this.held.player.shown ?? latest;
    if (latest === null || state === null || state === this.drawn) {
      return;
    }
    this.drawn = state;
    picture.contents.setMarkers({
      probe: state.proxy,
      radius: state.probe_radius,
      contactPoint: state.contact_point,
      normal: state.normal,
      trail: this.trail,
      parts,
      show: this.shown,
      tool: this.held.player.showing ? null : shownTool(latest, camera, this.held.needle.plan),
      device: state.device,
      force: state.force,
      contact: state.contact,
      pixel: pixelSizeAt(camera, state.proxy, viewport),
      fullForce: settings?.force_limit ?? 4,
    });
  }
}

const toolPaints = {
  eraser: srgbFromHex(toolColours.eraser),
  adder: srgbFromHex(toolColours.adder),
  painter: srgbFromHex(toolColours.painter),
  drill: srgbFromHex(toolColours.drill),
  needle: srgbFromHex(toolColours.needle),
} as const;

function shownTool(state: State, camera: Camera, plan: NeedlePlan | null): ShownTool | null {
  const { kind, radius } = state.tool;
  return kind === "none" ? null : { radius, colour: toolPaints[kind], line: toolLine(state, camera, plan) };
}
