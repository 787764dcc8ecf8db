import { expect, test } from "vitest";
import type { TissueMemory } from "../../../../src/core/tissue/tissue_memory";
import type { ModelParticles } from "../../../../src/core/tissue/particles";
import { usualOptions } from "../../../../src/core/tissue/model_options";
import type { ForceSource, FromPage, MatterRegion, State } from "../../../../src/core/protocol";
import { TissueControl } from "../../../../src/ui/features/tissue/tissue_control.svelte";
import { PageSteps } from "../../../../src/ui/state/page_steps.svelte";
import { ScanMemory } from "../../../../src/ui/state/scan_memory";
import type { Session } from "../../../../src/ui/state/session.svelte";

const fades = { shares: { least: 0.01, most: 0.95 }, times: { least: 0.01, most: 1000 } };
const yields = { least: 0.005, most: 0.5 };

const soft = { young: 5500, poisson: 0.45, density: 1060, fracture_energy: null, friction: 0.2, stiffening: 0 };
const liver = { preset: "liver", low: soft, high: soft };

/**
 * A page of a scan with one segment, an engine that does what is asked of it when the test lets it, and what the
 * browser keeps.
 */
class Visit {
  readonly sent: FromPage[] = [];
  greetings = 1;
  readonly scan = { name: "scan" };
  segments: { id: number; name: string; material: typeof liver | null; regions: MatterRegion[] }[] = [
    { id: 1, name: "Liver", material: null, regions: [] },
  ];
  readonly presets = [{ name: "liver" }];
  readonly models = [
    {
      name: "lattice",
      boxes: null,
      binding: null,
      walls: false,
      fades,
      yields,
      layers: null,
      calibration: false,
      motion: false,
      whole_segment: false,
    },
  ];
  latest: State | null = null;
  parts: ModelParticles | null = null;
  source: ForceSource = "matter";
  readonly steps = new PageSteps(() => 7);
  readonly control: TissueControl;
  private listener: (state: State) => void = () => undefined;
  private told: (() => void)[] = [];

  constructor(readonly memory: ScanMemory) {
    this.control = new TissueControl(this as unknown as Session, this.steps);
  }

  onState(listener: (state: State) => void): void {
    this.listener = listener;
  }

  send(message: FromPage): void {
    this.sent.push(message);
  }

  whenAnswered(told: () => void): void {
    this.told.push(told);
  }

  /** A state of an engine that holds this. */
  holds(material: typeof liver | null, model: "lattice" | null, { time, answers } = { time: 1, answers: 0 }): void {
    this.segments = [{ id: 1, name: "Liver", material, regions: [] }];
    this.latest = { time, matter: { model, options: usualOptions, force_source: this.source, answers } } as State;
    this.listener(this.latest);
  }

  /** The engine has done all that was sent. */
  passed(): void {
    for (const told of this.told.splice(0)) {
      told();
    }
  }

  /** What the next visit will find. */
  get kept(): Partial<TissueMemory> | null {
    return this.memory.everything["matter"] ?? null;
  }
}

test("what is kept of materials is what the engine holds, also after undo and redo", () => {
  const visit = new Visit(new ScanMemory(() => undefined));
  visit.holds(null, null);
  visit.passed();
  expect(visit.kept).toBeNull();
  const chosen = { model: "lattice", materials: [{ segment: "Liver", preset: "liver", constants: null }] };
  visit.control.make({ id: 1, name: "Liver" } as never, "liver", null);
  visit.holds(liver, "lattice");
  expect(visit.kept).toMatchObject(chosen);
  // undo takes the material back, and the engine tells so
  visit.holds(null, "lattice");
  expect(visit.kept).toMatchObject({ model: "lattice", materials: [] });
  visit.holds(liver, "lattice");
  expect(visit.kept).toMatchObject(chosen);
});

test("another visit brings back what was kept, and keeps what undo does then", () => {
  const memory = new ScanMemory(() => undefined);
  const first = new Visit(memory);
  first.holds(null, null);
  first.passed();
  first.control.make({ id: 1, name: "Liver" } as never, "liver", null);
  first.holds(liver, "lattice");
  const again = new Visit(memory);
  again.holds(null, null);
  // the engine has not done it yet: nothing is lost meanwhile
  again.holds(null, null);
  expect(again.kept).toMatchObject({ materials: [{ preset: "liver" }] });
  expect(again.sent.map(({ type }) => type)).toEqual(["set_material", "set_deformation"]);
  again.holds(liver, "lattice");
  again.passed();
  again.holds(null, "lattice");
  expect(again.kept).toMatchObject({ model: "lattice", materials: [] });
});

test("an engine that begins anew is told again, and takes nothing from what is kept", () => {
  const visit = new Visit(new ScanMemory(() => undefined));
  visit.holds(null, null);
  visit.passed();
  visit.control.make({ id: 1, name: "Liver" } as never, "liver", null);
  visit.holds(liver, "lattice");
  visit.sent.length = 0;
  visit.greetings += 1;
  visit.holds(null, null);
  visit.holds(null, null);
  expect(visit.kept).toMatchObject({ materials: [{ preset: "liver" }] });
  expect(visit.sent).toHaveLength(2);
});

test("regions are a step of the page's undo; a material is one of the engine's", () => {
  const visit = new Visit(new ScanMemory(() => undefined));
  visit.holds(liver, "lattice");
  const rigid: MatterRegion = { treatment: "rigid", shared_with: null, box: null };
  const segment = visit.segments[0] as never;
  visit.sent.length = 0;
  visit.control.setRegions(segment, [rigid]);
  expect(visit.steps.toUndo).toBe("zones of tissue");
  visit.steps.undo();
  visit.steps.redo();
  expect(visit.sent).toEqual([[rigid], [], [rigid]].map((regions) => ({ type: "set_regions", id: 1, regions })));
  visit.steps.undo();
  visit.control.make(segment, "liver", null);
  expect(visit.steps.canUndo).toBe(false);
});

test("what is felt is a step of the page's undo, kept, and told to the next engine", () => {
  const memory = new ScanMemory(() => undefined);
  const visit = new Visit(memory);
  visit.holds(liver, "lattice");
  visit.passed();
  visit.sent.length = 0;
  visit.control.feel("matter");
  expect(visit.sent).toEqual([]);
  visit.control.feel("voxels");
  visit.steps.undo();
  visit.steps.redo();
  expect(visit.sent).toEqual(["voxels", "matter", "voxels"].map((source) => ({ type: "set_force_source", source })));
  visit.source = "voxels";
  visit.holds(liver, "lattice");
  expect(visit.kept).toMatchObject({ forceSource: "voxels" });
  const again = new Visit(memory);
  again.holds(null, null);
  expect(again.sent).toContainEqual({ type: "set_force_source", source: "voxels" });
});

test("parts that arrive after they were hidden do not stay", () => {
  const visit = new Visit(new ScanMemory(() => undefined));
  const parts = { count: 3 } as ModelParticles;
  visit.control.showParts(true);
  visit.holds(liver, "lattice", { time: 1, answers: 0 });
  visit.parts = parts;
  visit.holds(liver, "lattice", { time: 2, answers: 30 });
  expect(visit.parts).toBe(parts);
  visit.control.showParts(false);
  // they were on their way already
  visit.parts = parts;
  visit.holds(liver, "lattice", { time: 3, answers: 60 });
  expect(visit.parts).toBeNull();
});
