/**
 * The tool in the person's hand: which one, how large, what it works on, and when it is pressed.
 */
import { formatFixed } from "../../../core/base/format";
import { likelyLayer, type Layer } from "../../../core/tools/needle";
import type { Segment, State, TissueName, ToolKind } from "../../../core/protocol";
import { fittingRadius, segmentsOf, type ToolName, type Works } from "../../../core/tools/tools";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";
import type { TouchPaint } from "./touch_paint.svelte";

type Layers = Readonly<Record<string, Layer>>;

/** What segments are to a needle is kept with the scan under this name: another's may have the same names. */
const part = "needle";

type Radii = Partial<Record<ToolName, number>>;

export class ToolHand {
  kind = $state<ToolKind>("none");
  works = $state<Works>("touched");
  /** Whether a stroke is on, as far as this page is concerned. */
  pressed = $state(false);
  /** What segments are to a needle, by their names, as far as the person has said. */
  private layers = $state.raw<Layers>({});
  private radii = $state.raw<Radii>(recall<Radii>("tools", {}));

  /** The segment that is touched, or was last. */
  private touched = 0;
  /** What was sent to the engine last, as text. */
  private told = "";
  /** What is to be done once there is a segment to paint with. */
  private waiting: "tool" | "stroke" | null = null;
  /** No stroke begins. */
  private held = false;
  /** Until the engine has told its first state to this page. */
  private isNew = true;
  /** The probe's radius before it took that of the burr [mm], also for the next visit; null where it has its own. */
  private ownRadius = recall<{ ownRadius: number | null }>("probe", { ownRadius: null }).ownRadius;

  constructor(
    private readonly session: Session,
    readonly paint: TouchPaint,
  ) {
    session.onState((state) => {
      this.takeUp(state);
      this.follow(state);
    });
    session.memory.onChange((name) => {
      if (name === part) {
        this.layers = session.memory.recall<Layers>(part, {});
      }
    });
    paint.onChange(() => {
      this.tell();
    });
  }

  /** Radius of the tool in the hand [mm]; 0 of none. */
  get radius(): number {
    const { scan } = this.session;
    return this.kind === "none" || scan === null
      ? 0
      : fittingRadius(this.kind, scan.spacing, this.radii[this.kind] ?? null);
  }

  choose(kind: ToolKind): void {
    this.release();
    this.kind = kind;
    if (this.isPrepared("tool")) {
      this.tell();
    }
    this.fitProbe();
  }

  setRadius(radius: number): void {
    if (this.kind !== "none") {
      this.radii = { ...this.radii, [this.kind]: radius };
      remember("tools", this.radii);
      this.tell();
      this.fitProbe();
    }
  }

  setWorks(works: Works): void {
    this.works = works;
    this.tell();
  }

  /** What a segment is to a needle. */
  layerOf(segment: Segment): Layer {
    return this.layers[segment.name] ?? likelyLayer(segment);
  }

  setLayer(segment: Segment, layer: Layer): void {
    this.layers = { ...this.layers, [segment.name]: layer };
    this.session.memory.keep(part, this.layers);
    this.tell();
  }

  /** Holds the tool, so that no stroke begins, or lets it work again. */
  hold(on: boolean): void {
    this.held = on;
    if (on) {
      this.release();
    }
  }

  /** Begins a stroke; false where there is no tool to begin it with. */
  press(): boolean {
    if (this.kind === "none") {
      return false;
    }
    if (!this.held && !this.pressed && this.isPrepared("stroke") && this.tell()) {
      this.pressed = true;
      if (this.kind === "painter") {
        this.paint.makeTouchable();
      }
      this.session.send({ type: "stroke", on: true });
    }
    return true;
  }

  release(): void {
    this.waiting &&= "tool";
    if (this.pressed) {
      this.pressed = false;
      this.session.send({ type: "stroke", on: false });
    }
  }

  /** Whether there is what the tool needs; else that comes first, and then what is wanted. */
  private isPrepared(wanted: "tool" | "stroke"): boolean {
    this.waiting = this.kind === "painter" && !this.paint.prepare() ? wanted : null;
    return this.waiting === null;
  }

  /**
   * Tells the engine what is chosen, where it does not know; false where there is nothing to work on. Then the engine
   * has no tool either: one that was put away is neither shown nor works on.
   */
  private tell(): boolean {
    const { kind } = this;
    const [segments, tissues] = this.worked();
    const isIdle = kind !== "none" && segments.length === 0;
    if (isIdle) {
      this.session.notify("info", nothingToWorkOn(kind, this.session.segments));
    }
    this.put(isIdle ? "none" : kind, segments, tissues);
    return !isIdle;
  }

  private put(kind: ToolKind, segments: number[], tissues: TissueName[]): void {
    const radius = kind === "none" ? 1 : this.radius;
    const how = kind === "painter" ? this.paint.how : { depth: null, overlaps: false };
    const text = JSON.stringify([this.session.greetings, kind, radius, segments, tissues, how]);
    if (text !== this.told) {
      this.told = text;
      this.session.send({ type: "tool", kind, radius, segments, tissues, ...how });
    }
  }

  /** The segments that the tool works on, and what they are to a needle. */
  private worked(): [number[], TissueName[]] {
    const { kind, works, touched } = this;
    const { segments } = this.session;
    if (kind === "none") {
      return [[], []];
    }
    if (kind === "painter") {
      return [[...this.paint.worked(works)], []];
    }
    if (kind !== "needle") {
      return [[...segmentsOf(kind, works, segments, touched)], []];
    }
    const soft = segments.flatMap((segment) => {
      const layer = this.layerOf(segment);
      return segment.felt && layer !== "hard" ? [{ id: segment.id, layer }] : [];
    });
    return [soft.map(({ id }) => id), soft.map(({ layer }) => layer)];
  }

  /** With the drill the probe has the burr's radius, so that it sinks in as the burr does. */
  private fitProbe(): void {
    const { settings } = this.session;
    if (settings === null) {
      return;
    }
    if (this.kind !== "drill") {
      if (this.ownRadius !== null) {
        this.session.changeSettings({ probe_radius: this.ownRadius });
        this.keepOwnRadius(null);
      }
      return;
    }
    if (this.ownRadius === null) {
      this.keepOwnRadius(settings.probe_radius);
      this.session.notify("info", `The probe is as large as the burr now: ${formatFixed(this.radius, 1, "mm")}.`);
    }
    this.session.changeSettings({ probe_radius: this.radius });
  }

  private keepOwnRadius(radius: number | null): void {
    this.ownRadius = radius;
    remember("probe", { ownRadius: radius });
  }

  /** Takes the tool that the engine has, as after this page was loaded anew, and the probe's radius without it. */
  private takeUp(state: State): void {
    if (!this.isNew) {
      return;
    }
    this.isNew = false;
    if (this.kind === "none") {
      this.kind = state.tool.kind;
      this.fitProbe();
    }
  }

  private follow(state: State): void {
    if (state.touched !== 0) {
      this.touched = state.touched;
    }
    const { waiting } = this;
    if (waiting !== null && this.paint.ready) {
      this.waiting = null;
      if (waiting === "stroke") {
        this.press();
      } else {
        this.tell();
      }
    }
  }
}

function nothingToWorkOn(kind: ToolKind, segments: readonly Segment[]): string {
  if (kind !== "needle" && segments.some(({ felt, locked }) => felt && locked)) {
    return "There is nothing to work on: what can be touched is locked. The lock in a segment's row opens it.";
  }
  if (segments.some(({ felt, touchable }) => touchable && !felt) && !segments.some(({ felt }) => felt)) {
    return "There is nothing to work on: what can be touched is hidden. The eye in a segment's row shows it.";
  }
  switch (kind) {
    case "needle":
      return "Nothing here is soft for the needle: choose a tissue for a segment that can be touched.";
    case "painter":
      return "There is nothing to paint: it takes a segment that can be touched, and another one to paint with.";
    default:
      return "There is no segment to work on: add one by a threshold.";
  }
}
