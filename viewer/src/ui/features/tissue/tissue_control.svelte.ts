/**
 * Soft tissue: what a person asks of materials and models, and what outlives a visit.
 */
import { AnswerRate, suggestedPreset, usualModel } from "../../../core/tissue/tissue";
import {
  recalledTissue,
  recalledRegions,
  rememberedTissue,
  type TissueMemory,
  type RememberedMaterial,
} from "../../../core/tissue/tissue_memory";
import { usualOptions } from "../../../core/tissue/model_options";
import type {
  Constants,
  ForceSource,
  FromPage,
  MatterRegion,
  ModelOptions,
  Segment,
  State,
} from "../../../core/protocol";
import type { PageSteps, StepOwner } from "../../state/page_steps.svelte";
import type { Session } from "../../state/session.svelte";

/** It is kept with the scan under this name. */
const part = "matter";

/**
 * What the engine's own undo does not know is a step of the page's: how it is asked for, and how for what was before.
 */
export class TissueControl implements StepOwner<FromPage> {
  /** Whether the model's nodes or particles are shown. */
  partsShown = $state(false);
  /** Segments that a person chose from many, to be listed though they are hard. */
  chosen = $state.raw<readonly number[]>([]);
  /** The segment that a person opened last in the list of segments: listed, too. */
  opened = $state<number | null>(null);
  /** The segment of which the page asks what it is made of; null where it asks of none. */
  asking = $state.raw<number | null>(null);
  private readonly answers = new AnswerRate();
  /** Greeting of the engine that was sent what was chosen at the last visit. */
  private recalledAt = 0;
  private shownTo = 0;
  /** What the engine held when that was kept last; null until it has done what was recalled. */
  private held: string | null = null;

  constructor(
    private readonly session: Session,
    private readonly steps: PageSteps,
  ) {
    session.onState((state) => {
      this.follow(state);
    });
  }

  /** Lists a segment, and asks what it is made of where its name does not tell. */
  list(segment: Segment): void {
    this.chosen = [...this.chosen, segment.id];
    this.asking = suggestedPreset(segment.name, this.session.presets) === null ? segment.id : null;
  }

  /** Makes a segment of the tissue that its name tells of; asks where it tells of none, or stops asking. */
  soften(segment: Segment): void {
    const suggested = suggestedPreset(segment.name, this.session.presets);
    if (suggested === null) {
      this.asking = this.asking === segment.id ? null : segment.id;
    } else {
      this.make(segment, suggested, null);
    }
  }

  /** What a segment is made of, by name or by its constants; hard with neither. */
  make(segment: Segment, preset: string | null, constants: Constants | null): void {
    const isSoft = preset !== null || constants !== null;
    this.asking = null;
    if (isSoft && this.session.latest?.matter.model === null) {
      // one step of undo is enough: a model without soft tissue changes nothing
      this.session.send({ type: "set_deformation", model: usualModel, options: usualOptions, undoable: false });
    }
    this.session.send({ type: "set_material", id: segment.id, preset, constants, undoable: true });
    this.keepFromNowOn();
  }

  /** How regions of a segment take part; of several that hold a voxel the last counts. */
  setRegions(segment: Segment, regions: MatterRegion[]): void {
    const before = [...segment.regions];
    this.ask(
      "zones of tissue",
      { type: "set_regions", id: segment.id, regions },
      { type: "set_regions", id: segment.id, regions: before },
    );
  }

  /** The deformation model, null for none, and what of it is not as usual. */
  choose(model: string | null, options: ModelOptions = usualOptions): void {
    this.session.send({ type: "set_deformation", model, options, undoable: true });
    this.keepFromNowOn();
  }

  /** What a tool feels of soft tissue. */
  feel(source: ForceSource): void {
    const before = this.session.latest?.matter.force_source ?? source;
    if (before !== source) {
      this.ask("what is felt", { type: "set_force_source", source }, { type: "set_force_source", source: before });
    }
  }

  /** All tissue is rigid again. */
  reset(): void {
    for (const segment of this.session.segments) {
      if (segment.material !== null) {
        this.session.send({ type: "set_material", id: segment.id, preset: null, constants: null, undoable: true });
      }
    }
    this.choose(null);
  }

  hold(asked: FromPage): void {
    this.session.send(asked);
  }

  showParts(on: boolean): void {
    this.partsShown = on;
    this.shownTo = this.session.greetings;
    this.session.send({ type: "show_parts", on });
    this.session.parts = null;
  }

  /** Answers of the model by now [Hz]; it changes with each state, more often than people read. */
  get rate(): number {
    return this.answers.hz;
  }

  /** Asks for what is one step of the page's undo. */
  private ask(name: string, after: FromPage, before: FromPage): void {
    this.session.send(after);
    this.steps.add(this, { name, before, after });
    this.keepFromNowOn();
  }

  private follow(state: State): void {
    const { matter, time } = state;
    this.answers.add(time, matter.answers);
    const { greetings } = this.session;
    if (this.recalledAt !== greetings) {
      this.recalledAt = greetings;
      this.held = null;
      this.recall(state);
      this.session.whenAnswered(() => {
        if (this.recalledAt === greetings) {
          this.held ??= this.holds(this.session.latest ?? state).text;
        }
      });
    }
    this.keep(state);
    if (this.partsShown && this.shownTo !== greetings) {
      this.showParts(true);
    }
    // a model that is not asked any more tells of parts no more; parts on their way when they were
    // hidden may still arrive
    if (!this.partsShown || matter.model === null || this.rate === 0) {
      this.session.parts = null;
    }
  }

  /** Keeps what the engine holds, whenever that is another: by a choice, undo or redo. */
  private keep(state: State): void {
    if (this.held === null) {
      return;
    }
    const { memory, text } = this.holds(state);
    if (text !== this.held) {
      this.held = text;
      this.session.memory.keep(part, memory);
    }
  }

  /** What a person chooses is kept, also before all was done that was recalled. */
  private keepFromNowOn(): void {
    this.held ??= "";
  }

  private holds({ matter }: State): { memory: TissueMemory; text: string } {
    const memory = rememberedTissue(this.session.segments, matter);
    return { memory, text: JSON.stringify(memory) };
  }

  /** Asks for what was chosen at the last visit, unless the engine was already asked for something else. */
  private recall({ matter }: State): void {
    const { session } = this;
    if (matter.model !== null || session.segments.some(({ material }) => material !== null)) {
      return;
    }
    const { presets, models } = session;
    const memory = recalledTissue(session.memory.recall(part, {}), presets, models);
    const { model, options, forceSource, materials } = memory;
    const kept = session.segments.map((segment) => ({
      id: segment.id,
      material: materials.find((each) => each.segment === segment.name),
    }));
    const known = kept.filter(
      (each): each is { id: number; material: RememberedMaterial } => each.material !== undefined,
    );
    for (const { id, material } of known) {
      session.send({
        type: "set_material",
        id,
        preset: material.preset,
        constants: material.constants,
        undoable: false,
      });
    }
    for (const { id, name } of session.segments) {
      const regions = recalledRegions(name, memory, session.segments);
      if (regions.length > 0) {
        session.send({ type: "set_regions", id, regions });
      }
    }
    if (forceSource !== matter.force_source) {
      session.send({ type: "set_force_source", source: forceSource });
    }
    if (model !== null) {
      session.send({ type: "set_deformation", model, options, undoable: false });
    }
  }
}
