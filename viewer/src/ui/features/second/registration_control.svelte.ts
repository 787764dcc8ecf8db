/**
 * Registration in a person's hand: what is chosen, pairs of points that are set by clicks in slices, and
 * what the engine tells of it. Each registration is one step of the page's undo.
 */
import { transformPoint } from "../../../core/geometry/affine";
import type { Mark } from "../../../core/marks/measure";
import type {
  PointPair,
  Registration,
  RegistrationKind,
  RegistrationMetric,
  RegistrationStart,
} from "../../../core/protocol";
import { apart, leastPairs, mostPairs, pairsOfDistances, sanePairs, seenAt } from "../../../core/second/registration";
import { placeOf } from "../../../core/second/second_scan";
import type { Vec3 } from "../../../core/geometry/vector";
import { fetchFile, tellSaved } from "../../state/download";
import type { PageSteps, StepOwner } from "../../state/page_steps.svelte";
import { recall, remember } from "../../state/remembered";
import type { SecondControl } from "./second_control.svelte";
import type { Session } from "../../state/session.svelte";

export interface RegistrationHabits {
  readonly kind: RegistrationKind;
  readonly metric: RegistrationMetric;
  readonly start: RegistrationStart;
  /** Of the resampled scan's file. */
  readonly ending: ".nii.gz" | ".nrrd";
}

const usual: RegistrationHabits = { kind: "rigid", metric: "automatic", start: "as-it-stands", ending: ".nii.gz" };

/** A pair as it stands now [scene mm], and how far its points are apart [mm]. */
export interface ShownPair {
  readonly first: Vec3;
  readonly second: Vec3;
  readonly apart: number;
}

const takenBack = { type: "undo_registration" } as const;
const made = { type: "redo_registration" } as const;
type Asked = typeof takenBack | typeof made;

export class RegistrationControl implements StepOwner<Asked> {
  /** As the engine has reported it; null before it has. */
  reported = $state.raw<Registration | null>(null);
  habits = $state.raw<RegistrationHabits>(recall("registration", usual));
  /** A pair whose points are clicked; `first` is set already where it is not null. */
  placing = $state.raw<{ readonly first: Vec3 | null } | null>(null);
  saving = $state.raw(false);
  private pairs = $state.raw<readonly PointPair[]>([]);
  /** Identity of the second scan that they are of; null where there is none. */
  private pairsOf: string | null = null;

  constructor(
    private readonly session: Session,
    private readonly second: SecondControl,
    private readonly outside: { readonly steps: PageSteps },
  ) {
    session.memory.onChange((name) => {
      if (this.pairsOf !== null && name === this.part) {
        this.pairs = this.kept;
      }
    });
  }

  /** Takes what the engine tells. */
  take(reported: Registration): void {
    const steps = this.reported?.steps ?? 0;
    // undo and redo are reported too, but only a search ends
    if (this.running && reported.doing === null && reported.steps > steps) {
      this.outside.steps.add(this, { name: "registration", before: takenBack, after: made });
    }
    this.reported = reported;
  }

  /** Takes up what was set for this scan; another one has pairs of its own. */
  follow(identity: string | null): void {
    if (identity !== this.pairsOf) {
      this.pairsOf = identity;
      this.pairs = identity === null ? [] : this.kept;
      this.cancel();
    }
  }

  get running(): boolean {
    return (this.reported?.doing ?? null) !== null;
  }

  readonly shownPairs = $derived.by((): readonly ShownPair[] => {
    const place = this.place;
    return place === null
      ? []
      : this.pairs.map((pair) => ({ first: pair[0], second: seenAt(pair[1], place), apart: apart(pair, place) }));
  });

  /** Whether all is there that a search needs. */
  get ready(): boolean {
    return (
      !this.running &&
      this.second.reported !== null &&
      (this.habits.start !== "landmarks" || this.pairs.length >= leastPairs)
    );
  }

  change(part: Partial<RegistrationHabits>): void {
    this.habits = { ...this.habits, ...part };
    remember("registration", this.habits);
    if (this.habits.start !== "landmarks") {
      this.cancel();
    }
  }

  run(): void {
    if (this.ready) {
      this.cancel();
      const { kind, metric, start } = this.habits;
      this.session.send({ type: "register", kind, metric, start, pairs: start === "landmarks" ? [...this.pairs] : [] });
    }
  }

  stop(): void {
    this.session.send({ type: "stop_registration" });
  }

  show(which: "before" | "after"): void {
    this.session.send({ type: "show_registration", which });
  }

  undo(): void {
    this.hold(takenBack);
  }

  redo(): void {
    this.hold(made);
  }

  hold(asked: Asked): void {
    this.session.send(asked);
  }

  /** Whether one is made, or taken back: the panel does that too. */
  stands(asked: Asked): boolean {
    return (asked === made ? this.reported?.steps : this.reported?.undone) !== 0;
  }

  // --- pairs of points ---------------------------------------------------------------------

  /** Waits for a click on a place of the first scan, then on the same of the second. */
  startPair(): void {
    if (this.pairs.length < mostPairs) {
      this.placing = { first: null };
      this.second.only = "first";
    }
  }

  put(point: Vec3): void {
    const { placing, place } = this;
    if (placing === null || place === null) {
      return;
    }
    if (placing.first === null) {
      this.placing = { first: point };
      this.second.only = "second";
    } else {
      this.setPairs([...this.pairs, [placing.first, transformPoint(place, point)]]);
      // three are needed at least: the next one is asked for at once
      if (this.pairs.length < leastPairs) this.startPair();
      else this.cancel();
    }
  }

  cancel(): void {
    this.placing = null;
    this.second.only = null;
  }

  remove(index: number): void {
    this.setPairs(this.pairs.filter((_, i) => i !== index));
  }

  addDistances(marks: readonly Mark[]): void {
    const { place } = this;
    if (place !== null) {
      this.setPairs([...this.pairs, ...pairsOfDistances(marks, place)].slice(0, mostPairs));
    }
  }

  private setPairs(pairs: readonly PointPair[]): void {
    this.pairs = pairs;
    this.session.memory.keep(this.part, { list: pairs });
  }

  private get place(): ReturnType<typeof placeOf> {
    return this.second.reported === null ? null : placeOf(this.second.reported);
  }

  /** Pairs as they are kept with the first scan. */
  private get kept(): readonly PointPair[] {
    return sanePairs(this.session.memory.recall<{ list: unknown }>(this.part, { list: [] }).list);
  }

  private get part(): string {
    return `landmarks.${this.pairsOf ?? ""}`;
  }

  // --- files -------------------------------------------------------------------------------

  /** Has the browser keep the transform as it stands, its inverse, or the second scan on the first one's grid. */
  async save(what: "transform" | "inverse" | "scan"): Promise<void> {
    if (this.saving) {
      return;
    }
    this.saving = true;
    try {
      const wanted = { what, ending: this.habits.ending };
      const { name, notes } = await fetchFile("/api/registration", wanted, what);
      tellSaved(this.session, name);
      for (const note of notes) {
        this.session.notify("warning", `${note}.`);
      }
    } catch (error) {
      this.session.notify("error", `Nothing was saved: ${error instanceof Error ? error.message : String(error)}`);
    } finally {
      this.saving = false;
    }
  }
}
