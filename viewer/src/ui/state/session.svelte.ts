/**
 * What the page knows of the engine: scan, segments, settings, and what is now.
 */
import { asSentence } from "../../core/base/format";
import { ForceHistory } from "../../core/touch/force_history";
import { decodeParticles, type ModelParticles } from "../../core/tissue/particles";
import { newThreshold, skinThreshold } from "../../core/segments/new_threshold";
import { recalled, remembered, sameSettings } from "../../core/touch/touch_settings";
import {
  PROTOCOL_VERSION,
  type Changed,
  type ClipPlanes,
  type CutPreview,
  type DeformationModel,
  type DeviceLimits,
  type DrawnPicture,
  type PictureFailed,
  type FromPage,
  type Gap,
  type Hello,
  type Grown,
  type Islands,
  type MaterialPreset,
  type NeedleEvent,
  type Notice,
  type Offer,
  type Outline,
  type Registration,
  type Scan,
  type Scissors,
  type SecondScan,
  type Segment,
  type Settings,
  type State,
  type ToPage,
} from "../../core/protocol";
import { Connection, type ConnectionState } from "../../live/connection";
import type { Silence } from "../../live/silence";
import { recall, remember } from "./remembered";
import { ScanMemory } from "./scan_memory";

export interface ShownNotice {
  readonly id: number;
  readonly level: Notice["level"];
  readonly text: string;
}

/** Seconds of force that are plotted, and samples kept for them. */
const plottedSeconds = 5;
const plottedSamples = 1500;
/** How often numbers on the page change [ms]: faster ones cannot be read. */
const readingPace = { usual: 80, calm: 200 } as const;
/** An answer of the engine that comes while a slider still moves waits this long [ms]. */
const answerRest = 250;
/** What is sent all the time and changes nothing that is taken back, and what asks whether all is done. */
const passing: ReadonlySet<FromPage["type"]> = new Set([
  "hand",
  "view",
  "turn_grabbed",
  "keep",
  "fence",
  "change_touch_clip",
  "picture_look",
  "draw_picture",
]);
const noticeTime = { info: 5000, warning: 12000, error: 30000 } as const;

export class Session {
  connection = $state.raw<ConnectionState>({ kind: "connecting" });
  /** How long nothing has come from the engine. */
  silence = $state.raw<Silence>("none");
  scan = $state.raw<Scan | null>(null);
  segments = $state.raw<readonly Segment[]>([]);
  /** Version of the segments' voxels that are no threshold. */
  labels = $state.raw(0);
  settings = $state.raw<Settings | null>(null);
  /** What `settings` were when the engine was started. */
  defaults = $state.raw<Settings | null>(null);
  /** Planes that the engine cuts the scene at for touch. */
  touchClip = $state.raw<ClipPlanes>([]);
  device = $state.raw("");
  deviceLimits = $state.raw<DeviceLimits | null>(null);
  /** Materials with a name, and deformation models. */
  presets = $state.raw<readonly MaterialPreset[]>([]);
  models = $state.raw<readonly DeformationModel[]>([]);
  version = $state.raw("");
  /** What is now, at a pace that can be read. */
  live = $state.raw<State | null>(null);
  /** Length of the recording that can be saved [s]; null where there is none. */
  recorded = $state.raw<number | null>(null);
  /** The gap that is watched; null before it was measured. */
  gap = $state.raw<Gap | null>(null);
  /** What a freehand line would part; null before the engine has reported it. */
  cutPreview = $state.raw<CutPreview | null>(null);
  /** What happened to the needle since it was taken in the hand. */
  needleEvents = $state.raw<readonly NeedleEvent[]>([]);
  /** What is being done to segments beside all else; null where nothing is. */
  segmentWork = $state.raw<string | null>(null);
  /** The segment of a table that was found, until a person has decided on it. */
  tableFound = $state.raw<number | null>(null);
  /** When the other page was opened that moves the hand (ISO 8601); null where none does. */
  handLed = $state.raw<string | null>(null);
  /** A region that was grown, until a person keeps it or not. */
  grown = $state.raw<Grown | null>(null);
  /** Whether a region is looked for. */
  growing = $state(false);
  /** Islands of a segment of which some would go, until a person has decided. */
  islands = $state.raw<Islands | null>(null);
  /** What scissors would cut out, until a person has decided. */
  scissors = $state.raw<Scissors | null>(null);
  /** The engine has found a table in the scan, and nobody has decided on it. */
  tableSuggested = $state.raw(false);
  notices = $state.raw<readonly ShownNotice[]>([]);
  /** Changes that an earlier session left, as long as nobody has decided about them. */
  offer = $state.raw<Offer | null>(null);
  /** How often the engine has refused something. */
  refusals = $state.raw(0);
  /** Why page and engine do not understand each other. */
  mismatch = $state.raw<string | null>(null);

  /** What is now, as it arrived; for the picture. */
  latest: State | null = null;
  /** Nodes or particles of the model of deformation, where they are shown; for the picture. */
  parts: ModelParticles | null = null;
  /** How often an engine has greeted this page: each time it must be sent the view again. */
  greetings = 0;
  readonly history = new ForceHistory(plottedSeconds, plottedSamples);

  /** What is kept with the scan. */
  readonly memory = new ScanMemory((message) => { this.send(message); });

  private readonly link: Connection;
  private listeners: readonly ((state: State) => void)[] = [];
  private secondListeners: readonly ((second: SecondScan) => void)[] = [];
  private registrationListeners: readonly ((registration: Registration) => void)[] = [];
  private outlineListener: (outline: Outline) => void = () => undefined;
  private drawnListener: (answer: DrawnPicture | PictureFailed) => void = () => undefined;
  private grownListener: () => void = () => undefined;
  private editListeners: readonly ((changed: Changed, arrived: number) => void)[] = [];
  /** Settings are shown as the engine holds them, and are kept for the next visit. */
  settingsHold = false;

  /** The settings as the engine has reported them last. */
  private answered: Settings | null = null;
  /** The fence behind the last change of settings. */
  private settingsFence = 0;
  /** The last fence, and the last one that the engine has passed. */
  private fences = 0;
  private passed = 0;
  private waiters: readonly { readonly fence: number; readonly passed: (tick: number) => void }[] = [];
  /** Commands that were sent, and how many of them the engine has reported a state after. */
  private commands = 0;
  private toldCommands = 0;
  private changedAt = -Infinity;
  private askingForSettings = false;
  private readAt = 0;
  private noticeCount = 0;

  /** @param calm changes the page less often, where every change of it is dear. */
  constructor(readonly calm: boolean) {
    this.link = new Connection({
      message: (message, arrived) => {
        this.receive(message, arrived);
      },
      state: (state) => {
        this.connection = state;
      },
      malformed: (text) => {
        this.mismatch ??= `The engine sent something this page does not know (${text}).`;
      },
      silence: (silence) => {
        this.silence = silence;
      },
      stoodStill: (seconds) => {
        const what = "What you asked of it meanwhile was not done.";
        this.notify("warning", `Palpate stood still for ${seconds}\u202fs. ${what}`);
      },
    });
  }

  /** What was told last is no longer what is: the engine is silent, or gone. */
  get isOld(): boolean {
    return this.live !== null && (this.connection.kind !== "open" || this.silence !== "none");
  }

  send(message: FromPage): void {
    this.commands += passing.has(message.type) ? 0 : 1;
    this.link.send(message);
  }

  /** Calls `listener` with every state that arrives until the returned function is called. */
  onState(listener: (state: State) => void): () => void {
    this.listeners = [...this.listeners, listener];
    return () => (this.listeners = this.listeners.filter((other) => other !== listener));
  }

  /** Calls back with what is reported of a second scan. */
  onSecond(listener: (second: SecondScan) => void): void {
    this.secondListeners = [...this.secondListeners, listener];
  }

  /** Calls back with what is reported of the second scan's registration. */
  onRegistration(listener: (registration: Registration) => void): void {
    this.registrationListeners = [...this.registrationListeners, listener];
  }

  /** Calls back with outlines that were asked for. */
  onOutline(listener: (outline: Outline) => void): void {
    this.outlineListener = listener;
  }

  /** Calls back with pictures that the engine has drawn for this page, and where it could not. */
  onDrawn(listener: (answer: DrawnPicture | PictureFailed) => void): void {
    this.drawnListener = listener;
  }

  /** Calls back with every region that was grown, or grown anew. */
  onGrown(listener: () => void): void {
    this.grownListener = listener;
  }

  /** Calls back with every edit that arrives, and when it did. */
  onChanged(listener: (changed: Changed, arrived: number) => void): void {
    this.editListeners = [...this.editListeners, listener];
  }

  /** Asks for other settings, at most once a frame; they are shown at once, the engine corrects them. */
  changeSettings(part: Partial<Settings>): void {
    if (this.settings === null) {
      return;
    }
    this.settings = { ...this.settings, ...part };
    this.settingsHold = false;
    this.changedAt = performance.now();
    if (!this.askingForSettings) {
      this.askingForSettings = true;
      requestAnimationFrame(() => {
        this.askingForSettings = false;
        if (this.settings !== null) {
          this.send({ type: "change_settings", settings: this.settings });
          this.settingsFence = this.fence();
        }
      });
    }
    setTimeout(() => {
      this.settle();
    }, answerRest);
  }

  /**
   * Calls back once the engine has done all that was sent until now, and has reported a state in which
   * touch follows it; or once another engine greets.
   */
  whenAnswered(told: () => void): void {
    const { commands } = this;
    const passed = (tick: number): void => {
      const stop = this.onState((state) => {
        if (state.tick >= tick) {
          stop();
          this.toldCommands = Math.max(this.toldCommands, commands);
          told();
        }
      });
    };
    this.waiters = [...this.waiters, { fence: this.fence(), passed }];
  }

  /** Whether the engine has reported a state after all commands that were sent. */
  get isSettled(): boolean {
    return this.toldCommands === this.commands;
  }

  /** Calls back as `whenAnswered` does; at once where nothing is left to be reported. */
  whenSettled(settled: () => void): void {
    if (this.isSettled) {
      settled();
    } else {
      this.whenAnswered(settled);
    }
  }

  /** Adds a segment by a threshold that suits the scan. */
  addThreshold(): void {
    if (this.scan !== null) {
      this.send({ type: "threshold", id: null, ...newThreshold(this.scan, this.segments) });
    }
  }

  /** Adds a segment of all that is not air, from the skin inward. */
  addSkin(): void {
    if (this.scan !== null) {
      this.send({ type: "threshold", id: null, ...skinThreshold(this.scan) });
    }
  }

  /** Begins a recording, or ends it; the engine's states tell whether it runs. */
  toggleRecording(): void {
    this.send({ type: "record", on: (this.latest?.recording ?? null) === null });
  }

  /** Brings back what an earlier session left, or keeps it aside. */
  recover(bringBack: boolean): void {
    this.offer = null;
    this.send({ type: "recover", bring_back: bringBack });
  }

  /** Back to what the engine was started with. */
  resetSettings(): void {
    if (this.defaults !== null) {
      this.changeSettings(this.defaults);
    }
  }

  /** Shows a sentence for a while. */
  notify(level: Notice["level"], told: string): void {
    const id = ++this.noticeCount;
    const text = asSentence(told);
    this.notices = [...this.notices.filter((notice) => notice.text !== text), { id, level, text }].slice(-4);
    setTimeout(() => {
      this.dismiss(id);
    }, noticeTime[level]);
  }

  dismiss(id: number): void {
    this.notices = this.notices.filter((notice) => notice.id !== id);
  }

  close(): void {
    this.link.close();
  }

  /** Takes a message of the engine; `arrived` as `performance.now()` tells time. */
  receive(message: ToPage, arrived: number): void {
    switch (message.type) {
      case "hello":
        this.greet(message);
        break;
      case "state":
        this.takeState(message);
        break;
      case "segments":
        this.segments = message.segments;
        this.labels = message.labels;
        break;
      case "changed":
        for (const listener of this.editListeners) {
          listener(message, arrived);
        }
        break;
      case "second_scan":
        this.secondListeners.forEach((listener) => { listener(message); });
        break;
      case "registration":
        this.registrationListeners.forEach((listener) => { listener(message); });
        break;
      case "kept":
        this.memory.take(message);
        break;
      case "recovery":
        this.offer = message.offer;
        break;
      case "settings_changed":
        this.answered = message.settings;
        this.settle();
        break;
      case "hand_led":
        this.handLed = message.opened;
        break;
      case "touch_clip_changed":
        this.touchClip = message.planes;
        break;
      case "passed":
        this.pass(message.number, message.tick);
        this.settle();
        break;
      case "matter_parts":
        this.parts = decodeParticles(message);
        break;
      case "gap":
        this.gap = message;
        break;
      case "outline":
        this.outlineListener(message);
        break;
      case "drawn_picture":
      case "picture_failed":
        this.drawnListener(message);
        break;
      case "cut_preview":
        this.cutPreview = message;
        break;
      case "table_found":
        this.tableFound = message.id;
        break;
      case "grown":
        this.grown = message;
        this.grownListener();
        break;
      case "islands":
        this.islands = message;
        break;
      case "scissors":
        this.scissors = message;
        break;
      case "table_suggested":
        this.tableSuggested = true;
        break;
      case "segment_work":
        this.segmentWork = message.what;
        this.growing = this.growing && message.what !== null;
        break;
      case "needle_events":
        this.needleEvents = message.events;
        break;
      case "notice":
        this.notify(message.level, message.text);
        this.refusals += message.level === "error" ? 1 : 0;
        break;
    }
  }

  private greet(hello: Hello): void {
    if (hello.protocol !== PROTOCOL_VERSION) {
      const theirs = String(hello.protocol);
      const own = String(PROTOCOL_VERSION);
      this.mismatch = `The engine speaks version ${theirs} of the protocol, this page version ${own}.`;
      return;
    }
    this.memory.greet(hello.kept);
    // the same scan after a lost connection needs no second download
    if (JSON.stringify(this.scan) !== JSON.stringify(hello.scan)) {
      this.scan = hello.scan;
    }
    this.segments = hello.segments;
    this.answered = hello.settings;
    this.settings = hello.settings;
    this.settingsHold = true;
    this.defaults = hello.defaults;
    this.touchClip = [];
    this.device = hello.device;
    this.deviceLimits = hello.device_limits;
    this.presets = hello.presets;
    this.models = hello.models;
    this.version = hello.version;
    this.history.clear();
    this.greetings += 1;
    this.segmentWork = null;
    this.tableFound = null;
    this.tableSuggested = false;
    this.handLed = null;
    this.grown = null;
    this.growing = false;
    this.islands = null;
    this.scissors = null;
    // what was asked before is forgotten with the connection that it was asked on
    this.pass(this.fences, 0);
    this.recallSettings(hello);
  }

  /** Applies what was set at the last visit, unless the engine was already asked for others. */
  private recallSettings({ settings, defaults, device }: Hello): void {
    const wanted = recalled(recall(memoryOf(device), {}), defaults);
    if (sameSettings(settings, defaults) && !sameSettings(wanted, defaults)) {
      this.changeSettings(wanted);
    }
  }

  /** Asks for an answer once all is done that was sent before; gives the number of the answer. */
  private fence(): number {
    this.fences += 1;
    this.send({ type: "fence", number: this.fences });
    return this.fences;
  }

  private pass(fence: number, tick: number): void {
    this.passed = Math.max(this.passed, fence);
    const passed = this.waiters.filter((waiter) => waiter.fence <= fence);
    this.waiters = this.waiters.filter((waiter) => waiter.fence > fence);
    for (const waiter of passed) {
      waiter.passed(tick);
    }
  }

  /** Whether the engine has answered the last change of settings, and not only one before. */
  private get answerIsNewest(): boolean {
    return !this.askingForSettings && this.passed >= this.settingsFence;
  }

  /** Shows the engine's answer once nothing moves any more, and keeps it for the next visit. */
  private settle(): void {
    const { answered, defaults, changedAt } = this;
    const moving = performance.now() - changedAt < answerRest - 1;
    if (answered === null || moving || !this.answerIsNewest) {
      return;
    }
    if (this.settings === null || !sameSettings(answered, this.settings)) {
      this.settings = answered;
    }
    if (defaults !== null) {
      remember(memoryOf(this.device), remembered(answered, defaults));
    }
    this.settingsHold = true;
  }

  private takeState(state: State): void {
    this.followRecording(this.latest?.recording ?? null, state.recording);
    this.latest = state;
    this.history.add(state.samples);
    for (const listener of this.listeners) {
      listener(state);
    }
    const now = performance.now();
    const pace = this.calm ? readingPace.calm : readingPace.usual;
    const turned =
      state.contact !== this.live?.contact || (state.recording === null) !== (this.live.recording === null);
    if (now - this.readAt >= pace || turned) {
      this.live = state;
      this.readAt = now;
    }
  }

  private followRecording(before: number | null, now: number | null): void {
    if (now !== null) {
      this.recorded = null;
    } else if (before !== null) {
      this.recorded = before;
    }
  }
}

/** Under which name settings are kept: a limit for one device is none for another. */
function memoryOf(device: string): string {
  return `touch.${device}`;
}
