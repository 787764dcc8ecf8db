/**
 * How a scan looks: a transfer function for bone in soft tissue, with few controls.
 *
 * The curve is anchored at two values of the scan, soft tissue and bone. In between it is
 * written in "tissue units" u: 0 at soft tissue, 1 at bone; with CT values (40 and 250 HU)
 * fat is at -0.7, contrast-filled vessels at 0.5..1.5, dense bone above 4.
 */
import { linearFromHex } from "../base/colour";
import { looks } from "./looks";
import type { ControlPoint, TransferFunction } from "./transfer_function";

/** Values between which the scan is drawn. */
export interface Anchors {
  readonly softTissue: number;
  readonly bone: number;
}

export interface SoftTissueAndBone {
  /** Value in the middle between soft tissue and bone. */
  readonly level: number;
  /** Span from soft tissue to bone. */
  readonly window: number;
  /** 0: soft tissue is clear, 1: skin is opaque. */
  readonly softTissue: number;
  /** 0: bone is clear, 1: opaque. */
  readonly bone: number;
}

export function defaultSoftTissueAndBone({ softTissue, bone }: Anchors): SoftTissueAndBone {
  const first = looks.tissue;
  return {
    level: (softTissue + bone) / 2,
    window: bone - softTissue,
    softTissue: first.softTissue,
    bone: first.bone,
  };
}

/** A stop of the curve: place in tissue units, colour, extinction at full strength [1/mm]. */
export interface Stop {
  readonly at: number;
  readonly colour: string;
  readonly soft: number;
  readonly bone: number;
}

// warm from skin over fat and muscle to contrast-filled vessels, ivory from spongy to dense bone
const { stops, strongestSoft, weakestSoft } = looks.tissue;

/** Strength of soft tissue for a slider 0..1: equal steps of the slider look equal. */
function softStrength(slider: number): number {
  return slider <= 0 ? 0 : weakestSoft * (strongestSoft / weakestSoft) ** slider;
}

/** The transfer function of an appearance, in values of the scan. */
export function transferFunctionOf(appearance: SoftTissueAndBone): TransferFunction {
  const soft = softStrength(appearance.softTissue);
  const window = Math.max(appearance.window, 1e-6);
  const points = stops.map((stop): ControlPoint => ({
    value: appearance.level + (stop.at - 0.5) * window,
    colour: linearFromHex(stop.colour),
    extinction: Math.max(stop.soft * soft, stop.bone * appearance.bone),
  }));
  return { points };
}
