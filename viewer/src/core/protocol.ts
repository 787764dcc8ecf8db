/**
 * Messages between engine and page, and the check of what arrives.
 *
 * Generated from `python/palpate/protocol/` by `python -m palpate.protocol.typescript`;
 * change it there. Each message is one msgpack map with a `type`. Points and vectors are
 * (x, y, z) in the scene frame, LPS [mm]; forces [N]; stiffness [N/mm]; times [s].
 */
import { decode, encode } from "@msgpack/msgpack";

export const PROTOCOL_VERSION = 1;

/** A number of a vector; the bounds keep NaN, infinity and absurd distances out. */
export type Coordinate = number;

/** x, y, z in the scene frame, LPS [mm]; forces [N]. */
export type Vector = readonly [Coordinate, Coordinate, Coordinate];

/** The same place in two scans. */
export type PointPair = readonly [Vector, Vector];

/** A value of the scan, in its unit; the bounds keep NaN and infinity out. */
export type Value = number;

/** What a person calls a segment. */
export type Name = string;

/** A segment's number; also its value in `/api/labels`. */
export type SegmentId = number;

/** A part of a whole, 0..1. */
export type Share = number;

/** Red, green, blue, sRGB, each 0..1. */
export type Colour = readonly [Share, Share, Share];

/** Of the spring between probe and device [N/mm]. */
export type Stiffness = number;

/** A Coulomb coefficient. */
export type Friction = number;

/** Whether a segment is drawn from its voxels, as a surface, or in both ways. */
export type ShownAs = "volume" | "surface" | "both";

/** What a surface is made from: the scan's values where a threshold made the segment, or bits. */
export type SurfaceSource = "intensities" | "bits";

/** On the light of one segment: 1 is that of the picture. */
export type LightFactor = number;

/** How often the vertices of a surface are moved to the mean of their neighbours. */
export type SmoothingDegree = number;

/** How the shape of a segment is changed; see `segmentation.changed_shape`. */
export type ShapeKind = "keep-largest" | "drop-small" | "fill-holes" | "between-slices" | "grow" | "shrink" | "smooth" | "median" | "joint" | "open" | "close" | "hollow-inside" | "hollow-outside" | "unite" | "subtract" | "intersect";

/** How freely a scan is moved: turned and shifted; scaled and sheared too; bent as well. */
export type RegistrationKind = "rigid" | "affine" | "bspline";

/** What tells that two scans are alike; automatic goes by their modalities. */
export type RegistrationMetric = "automatic" | "mutual-information" | "correlation" | "mean-squares";

/**
 * Where a search begins: where the second scan stands; middles of the grids or of what is bright;
 * pairs of points.
 */
export type RegistrationStart = "as-it-stands" | "centre" | "moments" | "landmarks";

/** What the probe does to voxels while it is pressed; none leaves them as they are. */
export type ToolKind = "none" | "eraser" | "adder" | "drill" | "needle" | "painter";

/** What a segment is for a needle; bone is none of them, since no needle punctures it. */
export type TissueName = "skin" | "fat" | "muscle" | "liver";

/**
 * What happens to a needle: it goes into a segment, comes into one that it has punctured or out of
 * all, comes to one that stops it, or is out.
 */
export type NeedleEventKind = "punctured" | "crossed" | "stopped" | "withdrawn";

/** How matter takes part: it gives, stays where it is, or is as if it were not there. */
export type Treatment = "deformable" | "rigid" | "empty";

/** What a tool feels of matter that gives way: the model's force, or its voxels until they move. */
export type ForceSource = "matter" | "voxels";

/** How the stiffness of particles follows from the material: by E, or by the speed of waves. */
export type Calibration = "young" | "wave-speed";

/** How particles come to rest: in scaled time with friction, or FIRE. */
export type Motion = "scaled-time" | "fire";

/** A model of deformation. */
export type ModelName = string;

/** A voxel's or a patch's place along one axis. */
export type Index = number;

/** Nodes of a box along one axis. */
export type NodeCount = number;

/** A voxel or a patch of a grid, along x, y, z. */
export type GridPlace = readonly [Index, Index, Index];

/** A rigid transform of the scene, row-major, shape [4, 4], translation in mm. */
export type Pose = readonly Coordinate[];

/** Counts of the scan's values in equal bins from `low` to `high`. */
export interface Histogram {
  readonly low: Value;
  readonly high: Value;
  readonly counts: readonly number[];
}

/** A range of values that stands for a tissue. */
export interface ThresholdPreset {
  readonly name: string;
  readonly low: Value;
  readonly high: Value;
}

/**
 * The scan on display; its values come by HTTP from `/api/volume`.
 *
 * `value = slope * stored + intercept`. `patient_from_grid` is row-major, shape
 * [4, 4]; grid coordinates are in voxels, voxel (i, j, k) covers [i, i+1) on each axis.
 * `unit` is "HU" only where it is known, else "". `title` is for windows: it names no file
 * that a person has not given by its path.
 */
export interface Scan {
  readonly name: string;
  readonly title: string;
  readonly modality: string;
  readonly unit: string;
  readonly dimensions: readonly [number, number, number];
  readonly spacing: Vector;
  readonly patient_from_grid: readonly number[];
  readonly slope: number;
  readonly intercept: number;
  readonly range: readonly [Value, Value];
  readonly histogram: Histogram;
  readonly soft_tissue: Value;
  readonly bone: Value;
  readonly presets: readonly ThresholdPreset[];
  readonly orientation_known: boolean;
  readonly warnings: readonly string[];
}

/**
 * How the surface of a segment feels; null is as the settings of touch say.
 *
 * Friction without one of its own is that of the segment's material, where it has one.
 */
export interface Feel {
  readonly stiffness: Stiffness | null;
  readonly friction_static: Friction | null;
  readonly friction_kinetic: Friction | null;
}

/**
 * What matter is: `young` [Pa], `poisson`, `density` [kg/m³], Coulomb `friction`.
 *
 * Bonds break at `breaking_strain`; null where none does.
 */
export interface Constants {
  readonly young: number;
  readonly poisson: number;
  readonly density: number;
  readonly breaking_strain: number | null;
  readonly friction: number;
}

/**
 * What a segment is made of: constants from `low` to `high` as they follow HU, or both.
 *
 * `preset` is its name; null where somebody chose the constants.
 */
export interface SegmentMaterial {
  readonly preset: Name | null;
  readonly low: Constants;
  readonly high: Constants;
}

/**
 * Some of a segment that takes part in its own way; all of it where nothing else is told.
 *
 * `shared_with`: what belongs to that other segment too. `box`: voxels (x, y, z) from the
 * first to one past the last. At most one of them is told.
 */
export interface MatterRegion {
  readonly treatment: Treatment;
  readonly shared_with: SegmentId | null;
  readonly box: readonly [GridPlace, GridPlace] | null;
}

/**
 * A segment of the scan.
 *
 * `range` holds the threshold (low, high) while the segment is just that threshold;
 * null where its voxels come from elsewhere: then they stand in `/api/labels` under
 * the segment's `id` (1..255). `made_by` is the threshold that made it, whatever edits
 * did since; null where none did. `pose` takes the segment from where the scan has it to
 * where it stands; null where it was not moved. `bounds` are the voxels that hold it, half
 * open; null where it is empty. `material` is null where it is hard; `regions` are those that
 * take part in their own way. `grid` is the `patient_from_grid` of its voxels where they are
 * not the scan's. `opacity`, `smoothing`, `surface_from` and `wireframe` are those of its
 * surface; `ambient` and `specular` are factors on its light. The voxels of a `locked` one
 * stay as they are.
 */
export interface Segment {
  readonly name: Name;
  readonly colour: Colour;
  readonly visible: boolean;
  readonly shown_as: ShownAs;
  readonly opacity: Share;
  readonly smoothing: SmoothingDegree;
  readonly surface_from: SurfaceSource;
  readonly wireframe: boolean;
  readonly ambient: LightFactor;
  readonly specular: LightFactor;
  readonly id: SegmentId;
  readonly touchable: boolean;
  readonly locked: boolean;
  readonly range: readonly [Value, Value] | null;
  readonly made_by: readonly [Value, Value] | null;
  readonly voxels: number;
  readonly volume_ml: number;
  readonly pending: boolean;
  readonly feel: Feel;
  readonly material: SegmentMaterial | null;
  readonly regions: readonly MatterRegion[];
  readonly pose: Pose | null;
  readonly bounds: readonly [GridPlace, GridPlace] | null;
  readonly grid: Pose | null;
}

/** What a person can set about touch; `gain` is scene mm per mm of the device. */
export interface Settings {
  readonly model: "exact" | "thesis-original" | "thesis-improved";
  readonly stiffness: Stiffness;
  readonly damping: number;
  readonly friction_static: Friction;
  readonly friction_kinetic: Friction;
  readonly smoothing: "intensities" | "bits" | "off";
  readonly probe_radius: number;
  readonly force_limit: number;
  readonly gain: number;
}

/**
 * What a device bears: settings that ask for more are cut to it.
 *
 * `reach` is how far it comes from the middle of its workspace [device mm].
 */
export interface DeviceLimits {
  readonly stiffness: Stiffness;
  readonly force: number;
  readonly reach: number;
}

/**
 * A material with a name, and where its constants are from.
 *
 * One that `needs_hounsfield` is for CT only: its constants go from `low` to `high`.
 */
export interface MaterialPreset {
  readonly name: Name;
  readonly source: string;
  readonly needs_hounsfield: boolean;
  readonly low: Constants;
  readonly high: Constants;
}

/** Boxes that a model can have, by the nodes or cells along each edge; these are odd. */
export interface Boxes {
  readonly least: number;
  readonly usual: number;
  readonly most: number;
}

/** Shares that can be chosen. */
export interface Shares {
  readonly least: number;
  readonly usual: number;
  readonly most: number;
}

/** Numbers that can be chosen where nothing is usual. */
export interface Range {
  readonly least: number;
  readonly most: number;
}

/** How a force can fade: shares of it, and time constants [s]. */
export interface Fading {
  readonly shares: Range;
  readonly times: Range;
}

/**
 * A model by which matter gives way, and what it offers to choose.
 *
 * `title` is its name as a person reads it. `bonded` ones are of nodes and bonds that can
 * break, the others of particles. `boxes` is null where it takes all matter, `binding` where
 * nothing is bound, `fades` where its force cannot; `yields` tells strains from which on
 * matter can stay as it is pressed, null where it always comes back. `layers` are so many at
 * most, null where its work is not parted.
 */
export interface DeformationModel {
  readonly name: ModelName;
  readonly title: string;
  readonly bonded: boolean;
  readonly boxes: Boxes | null;
  readonly binding: Shares | null;
  readonly walls: boolean;
  readonly fades: Fading | null;
  readonly yields: Range | null;
  readonly layers: number | null;
  readonly calibration: boolean;
  readonly motion: boolean;
}

/**
 * First message of the engine: everything the page needs to draw.
 *
 * `defaults` are the settings that the session was started with.
 */
export interface Hello {
  readonly type: "hello";
  readonly protocol: number;
  readonly version: string;
  readonly scan: Scan;
  readonly segments: readonly Segment[];
  readonly settings: Settings;
  readonly defaults: Settings;
  readonly device: string;
  readonly device_limits: DeviceLimits;
  readonly presets: readonly MaterialPreset[];
  readonly models: readonly DeformationModel[];
}

/** Where a moved segment stands by now: `Segment.pose` is where it was asked to go. */
export interface MovedPose {
  readonly id: SegmentId;
  readonly pose: Pose;
}

/**
 * The tool in the hand, and what it did in the stroke that is on, or in the last one.
 *
 * `radius` is that of its ball [mm]; `voxels` and `volume` [mm³] are what it changed,
 * `time` how long it was at work [s], `energy` the work done on matter [mJ], `load` the
 * power of this moment [mW]. Undo and redo hold on to `undo_bytes`, at most `undo_budget`.
 */
export interface ToolState {
  readonly kind: ToolKind;
  readonly radius: number;
  readonly on: boolean;
  readonly voxels: number;
  readonly volume: number;
  readonly time: number;
  readonly energy: number;
  readonly load: number;
  readonly undo_bytes: number;
  readonly undo_budget: number;
}

/**
 * A needle, where it is the tool in the hand or still in.
 *
 * `depth` is how far its tip is from where it went in [mm], `segment` the one at the tip, 0
 * for none. `tip` and `friction` are the forces at tip and shaft, `wall` that of what no
 * needle punctures [N]. `events` counts what `NeedleEvents` tells.
 */
export interface NeedleState {
  readonly inside: boolean;
  readonly depth: number;
  readonly segment: number;
  readonly tip: number;
  readonly friction: number;
  readonly wall: number;
  readonly events: number;
}

/** A force that fades while matter is held: this share of it, by this time constant [s]. */
export interface Prony {
  readonly share: number;
  readonly time: number;
}

/**
 * What is chosen of a model; null is as usual.
 *
 * `edge` counts nodes or cells along its box, `binding` is a share of a link's stiffness
 * (thesis 5.12), `walls` keep particles out of empty voxels (5.13), from `yield_strain` on
 * matter stays as it is pressed, `layers` part the work of an answer (5.21).
 */
export interface ModelOptions {
  readonly edge: number | null;
  readonly binding: number | null;
  readonly walls: boolean;
  readonly prony: Prony | null;
  readonly yield_strain: Stiffness | null;
  readonly layers: number | null;
  readonly calibration: Calibration | null;
  readonly motion: Motion | null;
}

/**
 * Matter that gives way: `model` is the one at work, null where all is hard.
 *
 * `options` tells what of it is not as usual.
 * `force` is that of the matter on the tool [N, scene], felt where `force_source` says so;
 * `answers` counts the model's answers.
 * While the next one is `late`, matter is as hard as its voxels. `nodes` take part in the
 * last answer; since the start `bonds_broken` bonds broke, which took `work_broken` [mJ].
 */
export interface MatterState {
  readonly model: ModelName | null;
  readonly options: ModelOptions;
  readonly force_source: ForceSource;
  readonly force: Vector;
  readonly answers: number;
  readonly late: boolean;
  readonly nodes: number;
  readonly bonds_broken: number;
  readonly work_broken: number;
}

/**
 * How a thread keeps its pace over the last second.
 *
 * `late` counts ticks since the start that began more than 2 ms after their time.
 */
export interface Rate {
  readonly asked_hz: number;
  readonly hz: number;
  readonly ticks: number;
  readonly late: number;
  readonly worst_late_ms: number;
}

/** One rate per thread; `real_time` says whether the priority was granted. */
export interface Rates {
  readonly device: Rate;
  readonly servo: Rate;
  readonly simulation: Rate;
  readonly picture: Rate;
  readonly real_time: boolean;
}

/**
 * Interventions of the safety stage and violations of the guarantees since start.
 *
 * `force` says what stands between the contact and the hand now: "on" where nothing does;
 * `off` why no force is sent, and nothing while forces are.
 */
export interface Safety {
  readonly clamped: number;
  readonly slewed: number;
  readonly not_finite: number;
  readonly ramped: number;
  readonly waited: number;
  readonly eased: number;
  readonly damped: number;
  readonly watchdog: number;
  readonly violations: number;
  readonly force: "on" | "waiting" | "ramping" | "easing" | "off";
  readonly off: "not-started" | "waiting" | "servo-late" | "stopped" | "not-finite" | null;
}

/**
 * What is now, some 60 times a second, latest wins.
 *
 * `samples` holds the ticks since the last state, thinned to at most 250 a second:
 * rows (time, force x, force y, force z). `contact_point` is where the force comes from:
 * on the smooth surface, beside `proxy`, which no solid voxel holds; `normal` points out
 * of the surface there, and is zero without contact. `probe_radius` is what the probe has
 * [mm]: less than the settings' where there is no room for it. `poses` says where moved
 * segments stand by now, `grabbed` which segment is in the hand, 0 for none.
 * `clutched` says that the device moves without the probe, `device_origin` is the middle of
 * its workspace. `step` counts the steps of undo that were made, less those that were taken
 * back; one that is not ended counts. `steps_made` counts those that were made and ended, ever:
 * where it rises, undone ones are forgotten. `recording` says since how long every input of the
 * servo is kept [s].
 */
export interface State {
  readonly type: "state";
  readonly tick: number;
  readonly time: number;
  readonly edit: number;
  readonly device: Vector;
  readonly hand: Vector;
  readonly proxy: Vector;
  readonly contact_point: Vector;
  readonly normal: Vector;
  readonly force: Vector;
  readonly contact: boolean;
  readonly depth: number;
  readonly touched: number;
  readonly probe_radius: number;
  readonly poses: readonly MovedPose[];
  readonly grabbed: number;
  readonly clutched: boolean;
  readonly device_origin: Vector;
  readonly pending: number;
  readonly can_undo: boolean;
  readonly can_redo: boolean;
  readonly step: number;
  readonly steps_made: number;
  readonly tool: ToolState;
  readonly needle: NeedleState;
  readonly matter: MatterState;
  readonly rates: Rates;
  readonly safety: Safety;
  readonly recording: number | null;
  readonly samples: readonly (readonly [number, number, number, number])[];
}

/** The segment list after a change; `labels` is the version of `/api/labels`. */
export interface Segments {
  readonly type: "segments";
  readonly segments: readonly Segment[];
  readonly labels: number;
}

/**
 * A box of voxels, from `low` up to, but without, `high`, as they are now.
 *
 * `stored` holds their stored values as little-endian int16, `labels` the number of each
 * voxel's segment as uint8, both with x fastest; null where they stay as they are.
 */
export interface ChangedVoxels {
  readonly low: GridPlace;
  readonly high: GridPlace;
  readonly stored: Uint8Array | null;
  readonly labels: Uint8Array | null;
}

/**
 * One patch of a segment's surface, where the scan has the segment (before its pose).
 *
 * `index` is its place in the grid of patches. `origin` is the lower corner and `size`
 * the edges of the box that its vertices lie in: position = origin + u16 / 65535 * size.
 *
 * `vertices` are x, y, z as little-endian uint16 each; `normals` x, y, z and a byte that
 * means nothing as int8 each, unit = int8 / 127; `triangles` three vertex numbers each,
 * little-endian uint16, or uint32 where there are more than 65536 vertices, counter-clockwise
 * as seen from outside.
 */
export interface SurfacePatch {
  readonly index: GridPlace;
  readonly origin: Vector;
  readonly size: Vector;
  readonly vertices: Uint8Array;
  readonly normals: Uint8Array;
  readonly triangles: Uint8Array;
}

/**
 * What changes in the surface of a segment: patches that are new or gone.
 *
 * `whole` forgets all patches that were sent before.
 */
export interface SegmentSurface {
  readonly id: SegmentId;
  readonly whole: boolean;
  readonly dropped: readonly GridPlace[];
  readonly patches: readonly SurfacePatch[];
}

/**
 * Where matter stands beside the voxels that show it, at the nodes of a box.
 *
 * Node (i, j, k) is at `origin + step * (i, j, k)` [grid], and `size` counts nodes along each
 * axis, 0 where all matter stands in its voxels. `moved` holds how far the matter of each node
 * stands from it as little-endian float16: x, y, z along the axes of the grid [mm] and a zero,
 * nodes with x fastest.
 */
export interface Displaced {
  readonly origin: Vector;
  readonly step: Vector;
  readonly size: readonly [NodeCount, NodeCount, NodeCount];
  readonly moved: Uint8Array;
}

/**
 * All that edits up to number `edit` change in the picture, shown in one and the same frame.
 *
 * Boxes of voxels are in the order of their edits: of two that overlap, the later one holds.
 * `applied` is when the oldest of these edits was applied [s since 1970]; null without one.
 * `displaced` goes with the voxels as they are then; null where it is as before.
 */
export interface Changed {
  readonly type: "changed";
  readonly edit: number;
  readonly applied: number | null;
  readonly voxels: readonly ChangedVoxels[];
  readonly surfaces: readonly SegmentSurface[];
  readonly displaced: Displaced | null;
}

/**
 * The nodes or particles of the model at work, where this page asked for them; latest wins.
 *
 * `places` are x, y, z as little-endian uint16 each: place = origin + number / 65535 * size
 * [scene]. `strains` are an int8 each: strain = number / 127 * 0.5, less than zero where matter
 * is pressed. `apart` is the distance of neighbours at rest [mm].
 */
export interface MatterParts {
  readonly type: "matter_parts";
  readonly origin: Vector;
  readonly size: Vector;
  readonly apart: number;
  readonly places: Uint8Array;
  readonly strains: Uint8Array;
}

/** The settings as the engine holds them. */
export interface SettingsChanged {
  readonly type: "settings_changed";
  readonly settings: Settings;
}

/**
 * Changes of this scan that an earlier session left: how many, when the last (ISO 8601).
 *
 * `lost_bytes` at the end of their file are not whole. `second`: name of the second scan that
 * was shown.
 */
export interface Offer {
  readonly steps: number;
  readonly when: string;
  readonly lost_bytes: number;
  readonly second: string | null;
}

/** What can be brought back; null once somebody has decided, or where there is nothing. */
export interface Recovery {
  readonly type: "recovery";
  readonly offer: Offer | null;
}

/** A sentence for the person at the page. */
export interface Notice {
  readonly type: "notice";
  readonly level: "info" | "warning" | "error";
  readonly text: string;
}

/**
 * The gap from the surface of segment `id` to segment `other`, as they stand by now.
 *
 * `minimum` and `mean` [mm], `overlap` [mm³]; null where one of them is gone or empty.
 */
export interface Gap {
  readonly type: "gap";
  readonly id: SegmentId;
  readonly other: SegmentId;
  readonly minimum: number | null;
  readonly mean: number | null;
  readonly overlap: number | null;
}

/**
 * The answer to a `Wire` or `TraceLevel` of this number, to the page that asked.
 *
 * A level's outline is closed, its last point joined to the first. Without points there is none,
 * for the reason that `problem` tells.
 */
export interface Outline {
  readonly type: "outline";
  readonly number: number;
  readonly points: readonly Vector[];
  readonly problem: string | null;
}

/**
 * Volumes of the parts that a painted cut would make of segment `id` [ml], larger first.
 *
 * Both are null where it would leave all of it on one side.
 */
export interface CutPreview {
  readonly type: "cut_preview";
  readonly id: SegmentId;
  readonly larger_ml: number | null;
  readonly smaller_ml: number | null;
}

/**
 * What happened to a needle at a time [s], in a segment, 0 for none.
 *
 * `depth` is from where it went in [mm], `force` that at its tip [N].
 */
export interface NeedleEvent {
  readonly kind: NeedleEventKind;
  readonly segment: number;
  readonly time: number;
  readonly depth: number;
  readonly force: number;
}

/** What happened to the needle since it was taken in the hand, oldest first, the newest 100. */
export interface NeedleEvents {
  readonly type: "needle_events";
  readonly events: readonly NeedleEvent[];
}

/** What is being done to segments beside all else; null where nothing is. */
export interface SegmentWork {
  readonly type: "segment_work";
  readonly what: string | null;
}

/**
 * A scan that is shown with the first; null where there is none any more.
 *
 * `second_from_first` maps points of the first scan to the second's, row-major, shape [4, 4],
 * patient of each [mm]; its values come from `/api/second` and are others with each `version`.
 * It `is_moved` where a transform holds it elsewhere than its own place in the patient says.
 */
export interface SecondScan {
  readonly type: "second_scan";
  readonly scan: Scan | null;
  readonly second_from_first: readonly number[];
  readonly is_moved: boolean;
  readonly version: number;
}

/** The metric after each step on one level of a registration; made small. */
export interface RegistrationLevel {
  readonly name: string;
  readonly values: readonly number[];
}

/**
 * What a registration has found: the metric before and after, and how far points move [mm].
 *
 * `overlap` is the share of the first scan that the second covers in the end.
 */
export interface FoundRegistration {
  readonly kind: RegistrationKind;
  readonly metric: RegistrationMetric;
  readonly before: number;
  readonly after: number;
  readonly overlap: Share;
  readonly moved_mean: number;
  readonly moved_most: number;
}

/**
 * How far the registration of the second scan is, and what the last one has found.
 *
 * `doing` and `share` are null where none runs, `failure` says why the last one changed
 * nothing; `curve` is that of the one that runs or ran last. `steps` counts registrations that
 * can be taken back, `undone` those that can be made again. `shown` tells whether the second
 * scan stands as before or after `found`.
 */
export interface Registration {
  readonly type: "registration";
  readonly doing: string | null;
  readonly share: Share | null;
  readonly curve: readonly RegistrationLevel[];
  readonly failure: string | null;
  readonly found: FoundRegistration | null;
  readonly shown: "before" | "after";
  readonly steps: number;
  readonly undone: number;
}

/**
 * The answer to a `Fence`: all that this page asked for before it is done.
 *
 * Touch follows it from `tick` on. Thresholds, growing and changes of shape are made beside all
 * others: they may come later.
 */
export interface Passed {
  readonly type: "passed";
  readonly number: number;
  readonly tick: number;
}

/** Where the hand pulls the device to [scene]; latest wins. */
export interface Hand {
  readonly type: "hand";
  readonly target: Vector;
}

/** Puts probe, device and hand at a point, or at the free voxel next to it. */
export interface Place {
  readonly type: "place";
  readonly point: Vector;
}

/** Axes of the view in the scene: the movement frame follows them (thesis 4.7). */
export interface View {
  readonly type: "view";
  readonly right: Vector;
  readonly up: Vector;
}

/** Has the device move without the probe, or with it again. */
export interface Clutch {
  readonly type: "clutch";
  readonly on: boolean;
}

/** Makes a segment of all voxels with low <= value <= high, or changes segment `id`. */
export interface Threshold {
  readonly type: "threshold";
  readonly id: SegmentId | null;
  readonly name: Name;
  readonly low: Value;
  readonly high: Value;
}

/** Makes a segment of each class of values but the lowest, by Otsu's thresholds. */
export interface Otsu {
  readonly type: "otsu";
  readonly classes: number;
}

/**
 * Makes a segment of what has values like those at `seed` and hangs together with them.
 *
 * `spread` is half of the range of values, in standard deviations around the seed. Passages
 * narrower than `passage` [mm] are not entered, and it becomes no larger than `most_ml`.
 */
export interface GrowSegment {
  readonly type: "grow_segment";
  readonly seed: Vector;
  readonly spread: number;
  readonly passage: number;
  readonly most_ml: number;
}

/**
 * Makes a segment of each of these: they grow until they meet where values change most.
 *
 * Values are smoothed by a Gaussian of this deviation [mm].
 */
export interface GrowSeeds {
  readonly type: "grow_seeds";
  readonly ids: readonly SegmentId[];
  readonly smoothing: number;
}

/**
 * Changes the shape of a segment; undo takes it back.
 *
 * `amount` counts islands to keep, is the volume from which on they stay [ml], or a length [mm];
 * `other` is the segment that is united, subtracted or intersected.
 */
export interface ChangeShape {
  readonly type: "change_shape";
  readonly id: SegmentId;
  readonly kind: ShapeKind;
  readonly amount: number;
  readonly other: SegmentId | null;
}

/** Stops what `SegmentWork` tells of and forgets what waits; what is not done is not begun. */
export interface StopSegmentWork {
  readonly type: "stop_segment_work";
}

/**
 * Finds where the second scan lies in the first; it then stands there, and undo takes it back.
 *
 * Each of `pairs` is a point of the first scan and the same place in the second, in the patient
 * of each.
 */
export interface Register {
  readonly type: "register";
  readonly kind: RegistrationKind;
  readonly metric: RegistrationMetric;
  readonly start: RegistrationStart;
  readonly pairs: readonly PointPair[];
}

/** Stops the registration that runs; nothing is changed then. */
export interface StopRegistration {
  readonly type: "stop_registration";
}

/** Shows the second scan as before the last registration, or as after it; no step of undo. */
export interface ShowRegistration {
  readonly type: "show_registration";
  readonly which: "before" | "after";
}

/** Takes the last registration back. */
export interface UndoRegistration {
  readonly type: "undo_registration";
}

/** Makes the registration again that was taken back last. */
export interface RedoRegistration {
  readonly type: "redo_registration";
}

/** Makes a segment without voxels, to be painted; undo takes it away. */
export interface NewSegment {
  readonly type: "new_segment";
  readonly name: Name;
}

/**
 * Paints voxels of a segment along points, or takes them away: a stroke until `EndPaint`.
 *
 * The brush has a radius [mm]. It is a disc in the slice with this `normal`, or a ball without
 * one, and changes only voxels with such `values`, where these are given.
 */
export interface Paint {
  readonly type: "paint";
  readonly id: SegmentId;
  readonly erases: boolean;
  readonly points: readonly Vector[];
  readonly radius: number;
  readonly normal: Vector | null;
  readonly values: readonly [Value, Value] | null;
}

/** Ends a stroke of the brush as one step of undo, or takes it back where it is not kept. */
export interface EndPaint {
  readonly type: "end_paint";
  readonly keep: boolean;
}

/** Asks for the path along edges of a slice from one point to another; see `Outline`. */
export interface Wire {
  readonly type: "wire";
  readonly number: number;
  readonly begin: Vector;
  readonly end: Vector;
  readonly normal: Vector;
}

/** Asks for the outline of the value at a point of a slice, through it; see `Outline`. */
export interface TraceLevel {
  readonly type: "trace_level";
  readonly number: number;
  readonly point: Vector;
  readonly normal: Vector;
}

/**
 * Paints what an outline in a slice encloses, or takes it away: one step of undo.
 *
 * Only voxels with such `values` are changed, where these are given.
 */
export interface FillOutline {
  readonly type: "fill_outline";
  readonly id: SegmentId;
  readonly erases: boolean;
  readonly points: readonly Vector[];
  readonly normal: Vector;
  readonly values: readonly [Value, Value] | null;
}

/** Changes how a segment looks and whether it can be touched, and its voxels changed. */
export interface SegmentProperties {
  readonly type: "segment_properties";
  readonly name: Name;
  readonly colour: Colour;
  readonly visible: boolean;
  readonly shown_as: ShownAs;
  readonly opacity: Share;
  readonly smoothing: SmoothingDegree;
  readonly surface_from: SurfaceSource;
  readonly wireframe: boolean;
  readonly ambient: LightFactor;
  readonly specular: LightFactor;
  readonly id: SegmentId;
  readonly touchable: boolean;
  readonly locked: boolean;
}

/** Changes how the surface of a segment feels. */
export interface SegmentFeel {
  readonly type: "segment_feel";
  readonly id: SegmentId;
  readonly feel: Feel;
}

/**
 * Tells what a segment is made of, by name or by constants; with neither it is hard.
 *
 * Undo takes it back where it is `undoable`: what a page asks for by itself is not.
 */
export interface SetMaterial {
  readonly type: "set_material";
  readonly id: SegmentId;
  readonly preset: Name | null;
  readonly constants: Constants | null;
  readonly undoable: boolean;
}

/**
 * Tells how regions of a segment take part: of several that hold a voxel the last counts.
 *
 * What is in none gives way.
 */
export interface SetRegions {
  readonly type: "set_regions";
  readonly id: SegmentId;
  readonly regions: readonly MatterRegion[];
}

/**
 * Chooses the model by which matter gives way, null makes all hard, and its options.
 *
 * Undo takes the choice back where it is `undoable`.
 */
export interface SetDeformation {
  readonly type: "set_deformation";
  readonly model: ModelName | null;
  readonly options: ModelOptions;
  readonly undoable: boolean;
}

/** Chooses what a tool feels of matter that gives way. */
export interface SetForceSource {
  readonly type: "set_force_source";
  readonly source: ForceSource;
}

/** Has this page told the nodes or particles of the model, or no more. */
export interface ShowParts {
  readonly type: "show_parts";
  readonly on: boolean;
}

/**
 * Moves a segment to a pose; latest wins, and the servo goes there smoothly.
 *
 * Moves of a drag that `goes_on` and the one that ends it are one step of undo.
 */
export interface MoveSegment {
  readonly type: "move_segment";
  readonly id: SegmentId;
  readonly pose: Pose;
  readonly goes_on: boolean;
}

/** Takes a segment in the hand, null lets go of it; `collides` stops it at the others. */
export interface Grab {
  readonly type: "grab";
  readonly id: SegmentId | null;
  readonly collides: boolean;
}

/** Turns the segment in the hand about the probe by a rotation vector [rad]. */
export interface TurnGrabbed {
  readonly type: "turn_grabbed";
  readonly rotation: Vector;
}

/** Parts a segment by the plane through a point; what lies before it is a new segment. */
export interface CutSegment {
  readonly type: "cut_segment";
  readonly id: SegmentId;
  readonly point: Vector;
  readonly normal: Vector;
}

/**
 * Parts a segment along a line painted on the picture, extruded away from the eye.
 *
 * `line` are points under it before the eye; `view` is where the eye looks. A `closed` line
 * joins its ends, an open one goes on straight. The smaller part is a new segment; with
 * `preview` nothing is cut, and `CutPreview` answers.
 */
export interface CutAlong {
  readonly type: "cut_along";
  readonly id: SegmentId;
  readonly line: readonly Vector[];
  readonly eye: Vector;
  readonly view: Vector;
  readonly closed: boolean;
  readonly preview: boolean;
}

/** Has the gap between two segments measured while they move; null ends that. */
export interface WatchGap {
  readonly type: "watch_gap";
  readonly pair: readonly [SegmentId, SegmentId] | null;
}

/**
 * Has the picture follow edits every so many-th of its frames, of 60 a second.
 *
 * Edits in between are shown together. The slowest of several pages sets the pace.
 */
export interface FollowEdits {
  readonly type: "follow_edits";
  readonly every: number;
}

/** Begins to keep every input of the servo, or ends it: the file is at `/api/recording`. */
export interface RecordSession {
  readonly type: "record";
  readonly on: boolean;
}

/** Removes a segment; undo brings it back. */
export interface RemoveSegment {
  readonly type: "remove_segment";
  readonly id: SegmentId;
}

/** Asks for new settings. */
export interface ChangeSettings {
  readonly type: "change_settings";
  readonly settings: Settings;
}

/** Asks to be told when all is done that the page asked for before; `number` comes back. */
export interface Fence {
  readonly type: "fence";
  readonly number: number;
}

/**
 * Chooses the tool for the next strokes: the radius of its ball [mm], and what it changes.
 *
 * Of a needle the radius is its own, and `tissues` say what each of its segments is. A painter
 * gives what is touched of the segments to the first of them, so `depth` below the surface [mm],
 * or in all of its ball; what is painted stays in its segment, too, where it `overlaps`.
 */
export interface Tool {
  readonly type: "tool";
  readonly kind: ToolKind;
  readonly radius: number;
  readonly segments: readonly SegmentId[];
  readonly tissues: readonly TissueName[];
  readonly depth: number | null;
  readonly overlaps: boolean;
}

/** Takes the needle out on the way that it went in. */
export interface WithdrawNeedle {
  readonly type: "withdraw_needle";
}

/** Begins a stroke of the tool, or ends it: what it changed is one step of undo. */
export interface Stroke {
  readonly type: "stroke";
  readonly on: boolean;
}

/** Brings back what an earlier session left, or keeps it aside and starts afresh. */
export interface Recover {
  readonly type: "recover";
  readonly bring_back: boolean;
}

/** Takes the last edit back. */
export interface Undo {
  readonly type: "undo";
}

/** Applies the last undone edit again. */
export interface Redo {
  readonly type: "redo";
}

/** A message of the engine. */
export type ToPage =
  | Hello
  | State
  | Segments
  | Changed
  | MatterParts
  | SettingsChanged
  | Recovery
  | Notice
  | Gap
  | Outline
  | CutPreview
  | NeedleEvents
  | SegmentWork
  | SecondScan
  | Registration
  | Passed;

/** A message of the page. */
export type FromPage =
  | Hand
  | Place
  | View
  | Clutch
  | Threshold
  | Otsu
  | GrowSegment
  | GrowSeeds
  | ChangeShape
  | StopSegmentWork
  | Register
  | StopRegistration
  | ShowRegistration
  | UndoRegistration
  | RedoRegistration
  | NewSegment
  | Paint
  | EndPaint
  | Wire
  | TraceLevel
  | FillOutline
  | SegmentProperties
  | SegmentFeel
  | SetMaterial
  | SetRegions
  | SetDeformation
  | SetForceSource
  | ShowParts
  | MoveSegment
  | Grab
  | TurnGrabbed
  | CutSegment
  | CutAlong
  | WatchGap
  | FollowEdits
  | RecordSession
  | RemoveSegment
  | ChangeSettings
  | Fence
  | Tool
  | WithdrawNeedle
  | Stroke
  | Recover
  | Undo
  | Redo;

/** A message that is not of the schema; says where and what was expected. */
export class ProtocolError extends Error {
  override name = "ProtocolError";
}

/** Unpacks a message of the engine; throws ProtocolError where it is not of the schema. */
export function decodeToPage(packed: ArrayBuffer | Uint8Array): ToPage {
  return checkToPage(unpack(packed));
}

/** Returns an unpacked message as what it is; throws ProtocolError where it is none. */
export function checkToPage(value: unknown): ToPage {
  const type = (value as { type?: unknown } | null | undefined)?.type;
  const check = typeof type === "string" ? TO_PAGE.get(type) : undefined;
  if (check === undefined) {
    throw new ProtocolError(`type: expected one of ${[...TO_PAGE.keys()].join(", ")}`);
  }
  check(value, String(type));
  return value as ToPage;
}

/** Packs a message for the engine. */
export function encodeFromPage(message: FromPage): Uint8Array<ArrayBuffer> {
  return encode(message);
}

function unpack(packed: ArrayBuffer | Uint8Array): unknown {
  try {
    return decode(packed);
  } catch (error) {
    throw new ProtocolError(`not msgpack: ${String(error)}`);
  }
}

/** Throws where a value is not as described; `path` names its place in the message. */
type Check = (value: unknown, path: string) => void;

interface Bounds {
  readonly ge?: number;
  readonly gt?: number;
  readonly le?: number;
  readonly lt?: number;
}

function expect(holds: boolean, path: string, expected: string): void {
  if (!holds) {
    throw new ProtocolError(`${path}: expected ${expected}`);
  }
}

function within(value: number, bounds: Bounds): boolean {
  const { ge = -Infinity, gt = -Infinity, le = Infinity, lt = Infinity } = bounds;
  return value >= ge && value > gt && value <= le && value < lt;
}

function real(bounds: Bounds = {}): Check {
  const expected = `a finite number ${JSON.stringify(bounds)}`;
  return (value, path) => {
    expect(Number.isFinite(value) && within(value as number, bounds), path, expected);
  };
}

function whole(bounds: Bounds = {}): Check {
  const expected = `a whole number ${JSON.stringify(bounds)}`;
  return (value, path) => {
    expect(Number.isInteger(value) && within(value as number, bounds), path, expected);
  };
}

function text(bounds: Bounds = {}): Check {
  const expected = `a text of length ${JSON.stringify(bounds)}`;
  return (value, path) => {
    expect(typeof value === "string" && within([...value].length, bounds), path, expected);
  };
}

const flag: Check = (value, path) => {
  expect(typeof value === "boolean", path, "true or false");
};

const bytes: Check = (value, path) => {
  expect(value instanceof Uint8Array, path, "bytes");
};

function oneOf(...allowed: readonly string[]): Check {
  return (value, path) => {
    expect(allowed.includes(value as string), path, `one of ${allowed.join(", ")}`);
  };
}

function nullable(check: Check): Check {
  return (value, path) => {
    if (value !== null) {
      check(value, path);
    }
  };
}

function list(check: Check): Check {
  return (value, path) => {
    expect(Array.isArray(value), path, "a list");
    (value as unknown[]).forEach((item, i) => {
      check(item, `${path}[${String(i)}]`);
    });
  };
}

function tuple(...checks: readonly Check[]): Check {
  return (value, path) => {
    expect(Array.isArray(value), path, "a list");
    const items = value as unknown[];
    expect(items.length === checks.length, path, `${String(checks.length)} items`);
    checks.forEach((check, i) => {
      check(items[i], `${path}[${String(i)}]`);
    });
  };
}

/** A map with exactly these fields. */
function record(fields: Readonly<Record<string, Check>>): Check {
  const names = Object.keys(fields);
  return (value, path) => {
    expect(typeof value === "object" && value !== null && !Array.isArray(value), path, "a map");
    const given = value as Readonly<Record<string, unknown>>;
    const extra = Object.keys(given).filter((name) => !Object.hasOwn(fields, name));
    expect(extra.length === 0, path, `no field ${extra.join(", ")}`);
    for (const name of names) {
      fields[name]?.(given[name], `${path}.${name}`);
    }
  };
}

const isCoordinate = real({ ge: -1000000, le: 1000000 });

const isVector = tuple(isCoordinate, isCoordinate, isCoordinate);

const isValue = real({ ge: -1000000000, le: 1000000000 });

const isName = text({ ge: 1, le: 100 });

const isSegmentId = whole({ ge: 1, le: 255 });

const isShare = real({ ge: 0, le: 1 });

const isColour = tuple(isShare, isShare, isShare);

const isStiffness = real({ gt: 0, le: 10 });

const isFriction = real({ ge: 0, le: 2 });

const isShownAs = oneOf("volume", "surface", "both");

const isSurfaceSource = oneOf("intensities", "bits");

const isLightFactor = real({ ge: 0, le: 3 });

const isSmoothingDegree = whole({ ge: 0, le: 12 });

const isRegistrationKind = oneOf("rigid", "affine", "bspline");

const isRegistrationMetric = oneOf("automatic", "mutual-information", "correlation", "mean-squares");

const isToolKind = oneOf("none", "eraser", "adder", "drill", "needle", "painter");

const isNeedleEventKind = oneOf("punctured", "crossed", "stopped", "withdrawn");

const isTreatment = oneOf("deformable", "rigid", "empty");

const isForceSource = oneOf("matter", "voxels");

const isCalibration = oneOf("young", "wave-speed");

const isMotion = oneOf("scaled-time", "fire");

const isModelName = text({ ge: 1, le: 40 });

const isIndex = whole({ ge: -2147483648, lt: 2147483648 });

const isNodeCount = whole({ ge: 0, le: 1024 });

const isGridPlace = tuple(isIndex, isIndex, isIndex);

const isPose = list(isCoordinate);

const isHistogram = record({
  low: isValue,
  high: isValue,
  counts: list(whole()),
});

const isThresholdPreset = record({
  name: text(),
  low: isValue,
  high: isValue,
});

const isScan = record({
  name: text(),
  title: text(),
  modality: text(),
  unit: text(),
  dimensions: tuple(whole(), whole(), whole()),
  spacing: isVector,
  patient_from_grid: list(real()),
  slope: real(),
  intercept: real(),
  range: tuple(isValue, isValue),
  histogram: isHistogram,
  soft_tissue: isValue,
  bone: isValue,
  presets: list(isThresholdPreset),
  orientation_known: flag,
  warnings: list(text()),
});

const isFeel = record({
  stiffness: nullable(isStiffness),
  friction_static: nullable(isFriction),
  friction_kinetic: nullable(isFriction),
});

const isConstants = record({
  young: real({ ge: 1, le: 2000000000000 }),
  poisson: real({ gt: -1, lt: 0.5 }),
  density: real({ ge: 0.1, le: 23000 }),
  breaking_strain: nullable(real({ gt: 0, le: 1000000 })),
  friction: real({ ge: 0, le: 10 }),
});

const isSegmentMaterial = record({
  preset: nullable(isName),
  low: isConstants,
  high: isConstants,
});

const isMatterRegion = record({
  treatment: isTreatment,
  shared_with: nullable(isSegmentId),
  box: nullable(tuple(isGridPlace, isGridPlace)),
});

const isSegment = record({
  name: isName,
  colour: isColour,
  visible: flag,
  shown_as: isShownAs,
  opacity: isShare,
  smoothing: isSmoothingDegree,
  surface_from: isSurfaceSource,
  wireframe: flag,
  ambient: isLightFactor,
  specular: isLightFactor,
  id: isSegmentId,
  touchable: flag,
  locked: flag,
  range: nullable(tuple(isValue, isValue)),
  made_by: nullable(tuple(isValue, isValue)),
  voxels: whole(),
  volume_ml: real(),
  pending: flag,
  feel: isFeel,
  material: nullable(isSegmentMaterial),
  regions: list(isMatterRegion),
  pose: nullable(isPose),
  bounds: nullable(tuple(isGridPlace, isGridPlace)),
  grid: nullable(isPose),
});

const isSettings = record({
  model: oneOf("exact", "thesis-original", "thesis-improved"),
  stiffness: isStiffness,
  damping: real({ ge: 0, le: 0.1 }),
  friction_static: isFriction,
  friction_kinetic: isFriction,
  smoothing: oneOf("intensities", "bits", "off"),
  probe_radius: real({ ge: 0, le: 20 }),
  force_limit: real({ gt: 0, le: 40 }),
  gain: real({ ge: 0.1, le: 10 }),
});

const isDeviceLimits = record({
  stiffness: isStiffness,
  force: real(),
  reach: real(),
});

const isMaterialPreset = record({
  name: isName,
  source: text(),
  needs_hounsfield: flag,
  low: isConstants,
  high: isConstants,
});

const isBoxes = record({
  least: whole(),
  usual: whole(),
  most: whole(),
});

const isShares = record({
  least: real(),
  usual: real(),
  most: real(),
});

const isRange = record({
  least: real(),
  most: real(),
});

const isFading = record({
  shares: isRange,
  times: isRange,
});

const isDeformationModel = record({
  name: isModelName,
  title: text(),
  bonded: flag,
  boxes: nullable(isBoxes),
  binding: nullable(isShares),
  walls: flag,
  fades: nullable(isFading),
  yields: nullable(isRange),
  layers: nullable(whole()),
  calibration: flag,
  motion: flag,
});

const isHello = record({
  type: oneOf("hello"),
  protocol: whole(),
  version: text(),
  scan: isScan,
  segments: list(isSegment),
  settings: isSettings,
  defaults: isSettings,
  device: text(),
  device_limits: isDeviceLimits,
  presets: list(isMaterialPreset),
  models: list(isDeformationModel),
});

const isMovedPose = record({
  id: isSegmentId,
  pose: isPose,
});

const isToolState = record({
  kind: isToolKind,
  radius: real(),
  on: flag,
  voxels: whole(),
  volume: real(),
  time: real(),
  energy: real(),
  load: real(),
  undo_bytes: whole(),
  undo_budget: whole(),
});

const isNeedleState = record({
  inside: flag,
  depth: real(),
  segment: whole(),
  tip: real(),
  friction: real(),
  wall: real(),
  events: whole(),
});

const isProny = record({
  share: real({ gt: 0, lt: 1 }),
  time: real({ gt: 0, le: 10000 }),
});

const isModelOptions = record({
  edge: nullable(whole({ ge: 1, le: 1001 })),
  binding: nullable(real({ ge: 0, le: 100 })),
  walls: flag,
  prony: nullable(isProny),
  yield_strain: nullable(isStiffness),
  layers: nullable(whole({ ge: 1, le: 100 })),
  calibration: nullable(isCalibration),
  motion: nullable(isMotion),
});

const isMatterState = record({
  model: nullable(isModelName),
  options: isModelOptions,
  force_source: isForceSource,
  force: isVector,
  answers: whole(),
  late: flag,
  nodes: whole(),
  bonds_broken: whole(),
  work_broken: real({ ge: 0 }),
});

const isRate = record({
  asked_hz: real(),
  hz: real(),
  ticks: whole(),
  late: whole(),
  worst_late_ms: real(),
});

const isRates = record({
  device: isRate,
  servo: isRate,
  simulation: isRate,
  picture: isRate,
  real_time: flag,
});

const isSafety = record({
  clamped: whole(),
  slewed: whole(),
  not_finite: whole(),
  ramped: whole(),
  waited: whole(),
  eased: whole(),
  damped: whole(),
  watchdog: whole(),
  violations: whole(),
  force: oneOf("on", "waiting", "ramping", "easing", "off"),
  off: nullable(oneOf("not-started", "waiting", "servo-late", "stopped", "not-finite")),
});

const isState = record({
  type: oneOf("state"),
  tick: whole(),
  time: real(),
  edit: whole(),
  device: isVector,
  hand: isVector,
  proxy: isVector,
  contact_point: isVector,
  normal: isVector,
  force: isVector,
  contact: flag,
  depth: real(),
  touched: whole(),
  probe_radius: real(),
  poses: list(isMovedPose),
  grabbed: whole(),
  clutched: flag,
  device_origin: isVector,
  pending: whole(),
  can_undo: flag,
  can_redo: flag,
  step: whole(),
  steps_made: whole(),
  tool: isToolState,
  needle: isNeedleState,
  matter: isMatterState,
  rates: isRates,
  safety: isSafety,
  recording: nullable(real()),
  samples: list(tuple(real(), real(), real(), real())),
});

const isSegments = record({
  type: oneOf("segments"),
  segments: list(isSegment),
  labels: whole(),
});

const isChangedVoxels = record({
  low: isGridPlace,
  high: isGridPlace,
  stored: nullable(bytes),
  labels: nullable(bytes),
});

const isSurfacePatch = record({
  index: isGridPlace,
  origin: isVector,
  size: isVector,
  vertices: bytes,
  normals: bytes,
  triangles: bytes,
});

const isSegmentSurface = record({
  id: isSegmentId,
  whole: flag,
  dropped: list(isGridPlace),
  patches: list(isSurfacePatch),
});

const isDisplaced = record({
  origin: isVector,
  step: isVector,
  size: tuple(isNodeCount, isNodeCount, isNodeCount),
  moved: bytes,
});

const isChanged = record({
  type: oneOf("changed"),
  edit: whole(),
  applied: nullable(real()),
  voxels: list(isChangedVoxels),
  surfaces: list(isSegmentSurface),
  displaced: nullable(isDisplaced),
});

const isMatterParts = record({
  type: oneOf("matter_parts"),
  origin: isVector,
  size: isVector,
  apart: real({ gt: 0 }),
  places: bytes,
  strains: bytes,
});

const isSettingsChanged = record({
  type: oneOf("settings_changed"),
  settings: isSettings,
});

const isOffer = record({
  steps: whole(),
  when: text(),
  lost_bytes: whole(),
  second: nullable(text()),
});

const isRecovery = record({
  type: oneOf("recovery"),
  offer: nullable(isOffer),
});

const isNotice = record({
  type: oneOf("notice"),
  level: oneOf("info", "warning", "error"),
  text: text(),
});

const isGap = record({
  type: oneOf("gap"),
  id: isSegmentId,
  other: isSegmentId,
  minimum: nullable(real()),
  mean: nullable(real()),
  overlap: nullable(real()),
});

const isOutline = record({
  type: oneOf("outline"),
  number: whole(),
  points: list(isVector),
  problem: nullable(text()),
});

const isCutPreview = record({
  type: oneOf("cut_preview"),
  id: isSegmentId,
  larger_ml: nullable(real()),
  smaller_ml: nullable(real()),
});

const isNeedleEvent = record({
  kind: isNeedleEventKind,
  segment: whole(),
  time: real(),
  depth: real(),
  force: real(),
});

const isNeedleEvents = record({
  type: oneOf("needle_events"),
  events: list(isNeedleEvent),
});

const isSegmentWork = record({
  type: oneOf("segment_work"),
  what: nullable(text()),
});

const isSecondScan = record({
  type: oneOf("second_scan"),
  scan: nullable(isScan),
  second_from_first: list(real()),
  is_moved: flag,
  version: whole(),
});

const isRegistrationLevel = record({
  name: text(),
  values: list(real()),
});

const isFoundRegistration = record({
  kind: isRegistrationKind,
  metric: isRegistrationMetric,
  before: real(),
  after: real(),
  overlap: isShare,
  moved_mean: real(),
  moved_most: real(),
});

const isRegistration = record({
  type: oneOf("registration"),
  doing: nullable(text()),
  share: nullable(isShare),
  curve: list(isRegistrationLevel),
  failure: nullable(text()),
  found: nullable(isFoundRegistration),
  shown: oneOf("before", "after"),
  steps: whole(),
  undone: whole(),
});

const isPassed = record({
  type: oneOf("passed"),
  number: whole(),
  tick: whole(),
});

const TO_PAGE: ReadonlyMap<string, Check> = new Map([
  ["hello", isHello],
  ["state", isState],
  ["segments", isSegments],
  ["changed", isChanged],
  ["matter_parts", isMatterParts],
  ["settings_changed", isSettingsChanged],
  ["recovery", isRecovery],
  ["notice", isNotice],
  ["gap", isGap],
  ["outline", isOutline],
  ["cut_preview", isCutPreview],
  ["needle_events", isNeedleEvents],
  ["segment_work", isSegmentWork],
  ["second_scan", isSecondScan],
  ["registration", isRegistration],
  ["passed", isPassed],
]);
