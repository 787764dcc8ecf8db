/**
 * Messages between engine and page, and the check of what arrives.
 *
 * Generated from `python/palpate/protocol/` by `python -m palpate.protocol.typescript`;
 * change it there. Each message is one msgpack map with a `type`. Points and vectors are
 * (x, y, z) in the scene frame, LPS [mm]; forces [N]; stiffness [N/mm]; times [s].
 */
import { decode, encode } from "@msgpack/msgpack";

export const PROTOCOL_VERSION = 1;

/** A coordinate of a vector; the bounds exclude NaN, infinity and absurd distances. */
export type Coordinate = number;

/** x, y, z in the scene frame, LPS [mm]; forces [N]. */
export type Vector = readonly [Coordinate, Coordinate, Coordinate];

/** Planes: a unit normal toward what is cut away, and `normal · point` of their points [mm]. */
export type ClipPlanes = readonly (readonly [Vector, Coordinate])[];

/** The same place in two scans. */
export type PointPair = readonly [Vector, Vector];

/** A value of the scan, in its unit; the bounds exclude NaN and infinity. */
export type Value = number;

/** Name of a segment. */
export type Name = string;

/** Name of a part of what is kept with a scan, such as "clip" or "mark.1f". */
export type KeptName = string;

/** A part of what is kept with a scan, as JSON; only pages understand it. */
export type KeptValue = string;

/** Number of a segment; also its value in `/api/labels`. */
export type SegmentId = number;

/** A fraction, 0 to 1. */
export type Share = number;

/** Red, green, blue, sRGB, each 0 to 1. */
export type Colour = readonly [Share, Share, Share];

/** Red, green or blue light, linear; 1 is white. */
export type LightAmount = number;

/** Red, green, blue, linear. */
export type LinearColour = readonly [LightAmount, LightAmount, LightAmount];

/** Stiffness of the spring between probe and device [N/mm]. */
export type Stiffness = number;

/** A Coulomb coefficient. */
export type Friction = number;

/** How a segment is drawn: from its voxels, as a surface, or both. */
export type ShownAs = "volume" | "surface" | "both";

/** What a surface is made from: the scan's values where a threshold made the segment, or its voxels. */
export type SurfaceSource = "intensities" | "bits";

/** Factor of the light of one segment, relative to that of the picture. */
export type LightFactor = number;

/** Number of times that vertices of a surface are moved to the mean of their neighbours. */
export type SmoothingDegree = number;

/** Operation on the shape of a segment; see `segmentation.changed_shape`. */
export type ShapeKind = "keep-largest" | "drop-small" | "fill-holes" | "between-slices" | "grow" | "shrink" | "smooth" | "median" | "joint" | "open" | "close" | "hollow-inside" | "hollow-outside" | "unite" | "subtract" | "intersect";

/** Step of a segment: a change of its shape, or what was painted, erased or drilled. */
export type StepKind = "keep-largest" | "drop-small" | "fill-holes" | "between-slices" | "grow" | "shrink" | "smooth" | "median" | "joint" | "open" | "close" | "hollow-inside" | "hollow-outside" | "unite" | "subtract" | "intersect" | "by-hand";

/** Transform of a registration: rigid, affine, or deformable as well. */
export type RegistrationKind = "rigid" | "affine" | "bspline";

/** Similarity of two scans; automatic depends on their modalities. */
export type RegistrationMetric = "automatic" | "mutual-information" | "correlation" | "mean-squares";

/**
 * Start of a registration: the current place of the second scan; centres of the grids or of bright
 * voxels; pairs of points.
 */
export type RegistrationStart = "as-it-stands" | "centre" | "moments" | "landmarks";

/** Tool at the probe; none changes nothing. */
export type ToolKind = "none" | "eraser" | "adder" | "drill" | "needle" | "painter";

/** Tissue of a segment for a needle; bone is not among them, since a needle does not puncture it. */
export type TissueName = "skin" | "fat" | "muscle" | "liver";

/**
 * Event of a needle: it punctures a segment, crosses into one that it has punctured or out of all,
 * is stopped, or is withdrawn.
 */
export type NeedleEventKind = "punctured" | "crossed" | "stopped" | "withdrawn";

/** How a region takes part in deformation: it deforms, is rigid, or counts as empty. */
export type Treatment = "deformable" | "rigid" | "empty";

/** Source of the force of soft tissue on a tool: the model, or voxels that are rigid until moved. */
export type ForceSource = "matter" | "voxels";

/** How the stiffness of particles follows from the material: from Young's modulus or wave speed. */
export type Calibration = "young" | "wave-speed";

/** How particles come to rest: in scaled time with damping, or by FIRE. */
export type Motion = "scaled-time" | "fire";

/** Name of a deformation model. */
export type ModelName = string;

/** Place of a voxel or a patch along one axis. */
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

/** A range of values of a tissue. */
export interface ThresholdPreset {
  readonly name: string;
  readonly low: Value;
  readonly high: Value;
}

/**
 * The displayed scan; its values are at `/api/volume`.
 *
 * `value = slope * stored + intercept`. `patient_from_grid` is row-major, shape [4, 4]; grid
 * coordinates are in voxels, voxel (i, j, k) covers [i, i+1) on each axis. `unit` is such
 * as "HU" or "SUVbw", "" where it is not known. `title` is for windows: it contains no file
 * name that the user did not type. `identity` is the same wherever the same scan lies
 * and however it is named. `patient` is whose scan it is, by name and number, "" where the file
 * does not say. `volume` is which of how many volumes of its file or series it is, such as
 * times, from 1; null where others cannot be opened. A `rereadable` scan can be
 * read again with what its files do not tell. `no_dicom` is why nothing in DICOM can refer to
 * it; null where something may. `notes` are no warnings: what was assumed or
 * changed in reading, and is hardly ever wrong.
 */
export interface Scan {
  readonly name: string;
  readonly title: string;
  readonly identity: string;
  readonly patient: string;
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
  readonly volume: readonly [number, number] | null;
  readonly rereadable: boolean;
  readonly no_dicom: string | null;
  readonly orientation_known: boolean;
  readonly warnings: readonly string[];
  readonly notes: readonly string[];
}

/** A part as it is now; a `value` of null is one that was removed. */
export interface KeptPart {
  readonly name: KeptName;
  readonly version: number;
  readonly value: KeptValue | null;
}

/**
 * Touch settings of a segment; null where the settings of the session apply.
 *
 * Without friction of its own, that of the segment's material applies, where it has one.
 */
export interface Feel {
  readonly stiffness: Stiffness | null;
  readonly friction_static: Friction | null;
  readonly friction_kinetic: Friction | null;
}

/**
 * Material constants: `young` [Pa], `poisson`, `density` [kg/m³], Coulomb `friction`.
 *
 * A crack takes `fracture_energy` [J/m²]; null where tissue never tears. `stiffening` is the
 * exponent with which tissue gets stiffer with strain, 0 for none.
 */
export interface Constants {
  readonly young: number;
  readonly poisson: number;
  readonly density: number;
  readonly fracture_energy: number | null;
  readonly friction: number;
  readonly stiffening: number;
}

/**
 * Material of a segment: constants from `low` to `high` by HU, or the same in both.
 *
 * `preset` is its name; null where the constants were given.
 */
export interface SegmentMaterial {
  readonly preset: Name | null;
  readonly low: Constants;
  readonly high: Constants;
}

/**
 * A region of a segment that deforms differently; the whole segment where no part is given.
 *
 * `shared_with`: the voxels that also belong to that segment. `box`: voxels (x, y, z) from the
 * first to one past the last. At most one of them is given.
 */
export interface MatterRegion {
  readonly treatment: Treatment;
  readonly shared_with: SegmentId | null;
  readonly box: readonly [GridPlace, GridPlace] | null;
}

/**
 * A step of a segment; `amount` as in `ChangeShape`.
 *
 * `other` is the name of the segment that was united, subtracted or intersected; its voxels are
 * those that it had then. A step that is not `on` is passed over.
 */
export interface SegmentStep {
  readonly kind: StepKind;
  readonly amount: number;
  readonly other: string | null;
  readonly on: boolean;
}

/**
 * How a segment is made: its source, and steps in order.
 *
 * `range` is the threshold of the source; null where the source is voxels that were drawn, grown
 * or read.
 */
export interface SegmentSteps {
  readonly range: readonly [Value, Value] | null;
  readonly steps: readonly SegmentStep[];
}

/**
 * A segment of the scan.
 *
 * `range` is the threshold (low, high) as long as the segment is exactly that threshold; null
 * where its voxels come from elsewhere: they are in `/api/labels` then, under the segment's
 * `id` (1..255). `made_by` is the threshold that made it, whatever edits did since; null where
 * none did. `pose` is the transform from its place in the scan to its current place; null where
 * it was not moved. `bounds` are the voxels of its bounding box, half open; null where it is
 * empty. `material` is null where it is rigid; `regions` are its regions that deform
 * differently. `grid` is the `patient_from_grid` of its voxels where they are not on the
 * scan's grid. `opacity`, `smoothing`, `surface_from` and `wireframe` are those of its
 * surface; `ambient` and `specular` are factors of its light. The voxels of a `locked`
 * segment cannot change. `touchable` is what is wanted; `felt` is whether the probe collides
 * with it: touchable, and visible or `touched_while_hidden`. `steps` is how it is made; null
 * where nothing is known but its voxels.
 */
export interface Segment {
  readonly name: Name;
  readonly colour: Colour;
  readonly visible: boolean;
  readonly touched_while_hidden: boolean;
  readonly shown_as: ShownAs;
  readonly opacity: Share;
  readonly smoothing: SmoothingDegree;
  readonly surface_from: SurfaceSource;
  readonly wireframe: boolean;
  readonly ambient: LightFactor;
  readonly specular: LightFactor;
  readonly id: SegmentId;
  readonly touchable: boolean;
  readonly felt: boolean;
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
  readonly steps: SegmentSteps | null;
}

/** Settings of touch; `gain` is scene mm per mm of the device. */
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
 * Limits of a device; larger settings are reduced to them.
 *
 * `reach` is the radius of its workspace [device mm].
 */
export interface DeviceLimits {
  readonly stiffness: Stiffness;
  readonly force: number;
  readonly reach: number;
}

/**
 * A material with a name, and the source of its constants.
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

/** Allowed sizes of a model's box: nodes or cells along each edge, odd numbers. */
export interface Boxes {
  readonly least: number;
  readonly usual: number;
  readonly most: number;
}

/** Allowed fractions, and the default. */
export interface Shares {
  readonly least: number;
  readonly usual: number;
  readonly most: number;
}

/** Allowed numbers, where there is no default. */
export interface Range {
  readonly least: number;
  readonly most: number;
}

/** Allowed stress relaxation: fractions of the force, and time constants [s]. */
export interface Fading {
  readonly shares: Range;
  readonly times: Range;
}

/**
 * A deformation model and the options it has.
 *
 * `title` is its name to display. `bonded` models consist of nodes and breakable bonds, the
 * others of particles. `boxes` is null where the model always deforms all tissue, `binding`
 * where it has no springs to the initial positions, `fades` where it has no stress relaxation;
 * `yields` are allowed yield strains, null where it is always elastic. `layers` is the largest
 * number of them, null where it has none.
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
  readonly whole_segment: boolean;
}

/**
 * First message of the engine: what the page needs to begin.
 *
 * `kept` is what is kept with the scan; `defaults` are the settings at the start of the
 * session.
 */
export interface Hello {
  readonly type: "hello";
  readonly protocol: number;
  readonly version: string;
  readonly scan: Scan;
  readonly kept: readonly KeptPart[];
  readonly segments: readonly Segment[];
  readonly settings: Settings;
  readonly defaults: Settings;
  readonly device: string;
  readonly device_limits: DeviceLimits;
  readonly presets: readonly MaterialPreset[];
  readonly models: readonly DeformationModel[];
}

/** Current pose of a moved segment; `Segment.pose` is the requested one. */
export interface MovedPose {
  readonly id: SegmentId;
  readonly pose: Pose;
}

/**
 * The tool in use, and what its current or last stroke did.
 *
 * `radius` is that of its ball [mm]; `voxels` and `volume` [mm³] are what it changed,
 * `time` its time at work [s], `energy` its work [mJ], `load` its current power [mW]. Undo
 * and redo take `undo_bytes`, at most `undo_budget`.
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
 * A needle that is in use or still inserted.
 *
 * `depth` is the distance of its tip from the point of entry [mm], `entry` that point in the
 * scene [mm] and `direction` the way inward, of length 1 (both zeros where it is out);
 * `segment` is the one at the tip, 0 for none. `tip` and `friction` are the forces at tip
 * and shaft, `wall` that of a rigid obstacle [N]. `events` is the number of `NeedleEvents`.
 * `set_direction` is the one that was set, inward, of length 1; null for that of the push.
 */
export interface NeedleState {
  readonly inside: boolean;
  readonly depth: number;
  readonly entry: Vector;
  readonly direction: Vector;
  readonly segment: number;
  readonly tip: number;
  readonly friction: number;
  readonly wall: number;
  readonly events: number;
  readonly set_direction: Vector | null;
}

/** Stress relaxation: the fraction of the force that decays, and the time constant [s]. */
export interface Prony {
  readonly share: number;
  readonly time: number;
}

/**
 * Options of a model; null is the default.
 *
 * `edge` counts nodes or cells along its box, `binding` is relative to a link's stiffness
 * (thesis 5.12), `walls` keep particles out of empty voxels (5.13), beyond `yield_strain`
 * deformation is plastic, `layers` divide the work of an answer (5.21). With
 * `whole_segment` the body behind the box gives as the whole segment does (5.29).
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
  readonly whole_segment: boolean;
}

/**
 * State of the deformation; `model` is the current one, null where every segment is rigid.
 *
 * `force` is that of the tissue on the tool [N, scene], sent where `force_source` says so;
 * `answers` counts the model's answers. While the next one is `late`, a hand at rest feels
 * the last one. After an answer tissue may be `settling` still, so that the force changes, or
 * its box a `small_box` because the computer is too slow for the usual one. `nodes` take part
 * in the last answer; since the start `bonds_broken` bonds
 * broke, which took `work_broken` [mJ].
 */
export interface MatterState {
  readonly model: ModelName | null;
  readonly options: ModelOptions;
  readonly force_source: ForceSource;
  readonly force: Vector;
  readonly answers: number;
  readonly late: boolean;
  readonly settling: boolean;
  readonly small_box: boolean;
  readonly nodes: number;
  readonly bonds_broken: number;
  readonly work_broken: number;
}

/**
 * How well a thread kept its rate in the last second.
 *
 * `late` counts ticks since the start that began more than 2 ms late.
 */
export interface Rate {
  readonly asked_hz: number;
  readonly hz: number;
  readonly ticks: number;
  readonly late: number;
  readonly worst_late_ms: number;
}

/** Rates of all threads; `real_time` says whether the system granted real-time priority. */
export interface Rates {
  readonly device: Rate;
  readonly servo: Rate;
  readonly simulation: Rate;
  readonly picture: Rate;
  readonly real_time: boolean;
}

/**
 * Interventions of the safety stage, and violations of guarantees, since the start.
 *
 * `force` says how the contact force is passed on: "on" where it is unchanged; `off` says why
 * no force is sent, null while one is.
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
 * Current state, about 60 times a second; latest wins.
 *
 * `samples` are the ticks since the last state, thinned to at most 250 a second: rows (time,
 * force x, force y, force z). `contact_point` is the origin of the force on the smooth surface,
 * near `proxy`, which never is in a solid voxel; `normal` points outward there, and is zero
 * without contact. `probe_radius` is the current radius of the probe [mm]: less than in the
 * settings where there is no room for it. `poses` are the current poses of moved segments,
 * `grabbed` the segment attached to the probe, 0 for none. `clutched` says that the device
 * moves without the probe, `device_origin` is the centre of its workspace. `step` counts the
 * steps of undo that are done, including one in progress. `steps_made` counts all completed
 * steps since the start; where it increases, undone ones are discarded. `recording` is the
 * length of the current recording [s].
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

/** The list of segments after a change; `labels` is the version of `/api/labels`. */
export interface Segments {
  readonly type: "segments";
  readonly segments: readonly Segment[];
  readonly labels: number;
}

/**
 * Current content of a box of voxels, from `low` up to, but without, `high`.
 *
 * `stored` are their stored values as little-endian int16, `labels` the number of each voxel's
 * segment as uint8, both with x fastest; null where they did not change.
 */
export interface ChangedVoxels {
  readonly low: GridPlace;
  readonly high: GridPlace;
  readonly stored: Uint8Array | null;
  readonly labels: Uint8Array | null;
}

/**
 * A patch of a segment's surface, at the segment's place in the scan (before its pose).
 *
 * `index` is its place in the grid of patches. `origin` is the lower corner and `size` the
 * edges of the box of its vertices: position = origin + u16 / 65535 * size.
 *
 * `vertices` are x, y, z as little-endian uint16 each; `normals` x, y, z and an unused byte as
 * int8 each, unit vector = int8 / 127; `triangles` three vertex numbers each, little-endian
 * uint16, or uint32 where there are more than 65536 vertices, counter-clockwise seen from outside.
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
 * Changes of the surface of a segment: patches that are new or `dropped`.
 *
 * `whole` discards all earlier patches.
 */
export interface SegmentSurface {
  readonly id: SegmentId;
  readonly whole: boolean;
  readonly dropped: readonly GridPlace[];
  readonly patches: readonly SurfacePatch[];
}

/**
 * Displacement of tissue from the voxels that show it, at the nodes of a box.
 *
 * Node (i, j, k) is at `origin + step * (i, j, k)` [grid], and `size` counts nodes along each
 * axis. `moved` is the displacement at each node as little-endian
 * float16: x, y, z along the axes of the grid [mm] and a zero, nodes with x fastest.
 */
export interface Displaced {
  readonly origin: Vector;
  readonly step: Vector;
  readonly size: readonly [NodeCount, NodeCount, NodeCount];
  readonly moved: Uint8Array;
}

/**
 * Changes of the picture by edits up to number `edit`, to be shown in one frame.
 *
 * Boxes of voxels are in the order of their edits: where two overlap, the later one counts.
 * `applied` is when the oldest of these edits was applied [s since 1970]; null without one.
 * `displaced` belongs to the voxels after the change: boxes of nodes whose displacements add up,
 * at most two; null where it did not change.
 */
export interface Changed {
  readonly type: "changed";
  readonly edit: number;
  readonly applied: number | null;
  readonly voxels: readonly ChangedVoxels[];
  readonly surfaces: readonly SegmentSurface[];
  readonly displaced: readonly Displaced[] | null;
}

/**
 * Nodes or particles of the current model, for pages that requested them; latest wins.
 *
 * `places` are x, y, z as little-endian uint16 each: place = origin + number / 65535 * size
 * [scene]. `strains` are an int8 each: strain = number / 127 * 0.5, negative in compression.
 * `apart` is the distance of neighbours at rest [mm].
 */
export interface MatterParts {
  readonly type: "matter_parts";
  readonly origin: Vector;
  readonly size: Vector;
  readonly apart: number;
  readonly places: Uint8Array;
  readonly strains: Uint8Array;
}

/** The settings in effect. */
export interface SettingsChanged {
  readonly type: "settings_changed";
  readonly settings: Settings;
}

/** The planes that cut the scene for touch, as `ChangeTouchClip` has them. */
export interface TouchClipChanged {
  readonly type: "touch_clip_changed";
  readonly planes: ClipPlanes;
}

/** Which other page moves the hand: when it was opened (ISO 8601); null where none does. */
export interface HandLed {
  readonly type: "hand_led";
  readonly opened: string | null;
}

/**
 * Changes of this scan that an earlier session left: their number, the time of the last.
 *
 * `when` is ISO 8601. `lost_bytes` is the number of damaged bytes at the end of their file.
 * `second` is the name of the second scan that was shown.
 */
export interface Offer {
  readonly steps: number;
  readonly when: string;
  readonly lost_bytes: number;
  readonly second: string | null;
}

/** Changes that can be recovered; null once that is decided, or where there are none. */
export interface Recovery {
  readonly type: "recovery";
  readonly offer: Offer | null;
}

/** A message for the user. */
export interface Notice {
  readonly type: "notice";
  readonly level: "info" | "warning" | "error";
  readonly text: string;
}

/**
 * A part is another one now.
 *
 * `answers` says that this answers a `Keep` of the same page: each is answered once, with what
 * holds then, whether it was taken or not.
 */
export interface Kept {
  readonly type: "kept";
  readonly part: KeptPart;
  readonly answers: boolean;
}

/**
 * The gap from the surface of segment `id` to segment `other`, at their current poses.
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
 * Answer to the `Wire` or `TraceLevel` with this number, to the page that sent it.
 *
 * The outline of a level is closed: its last point is connected to the first. Without points
 * `problem` says why there is no outline.
 */
export interface Outline {
  readonly type: "outline";
  readonly number: number;
  readonly points: readonly Vector[];
  readonly problem: string | null;
}

/**
 * A picture for the `DrawPicture` with this number; `finished`: it is the last one.
 *
 * `size` has columns and rows: those requested, divided by `divisor`, rounded up. Where it is
 * a `part` of such a picture, it has its first column and row there, and is to be put over one
 * of the same view that shows state `over` or a later one. `state` is the number of what it
 * shows, which rises with every change of that. Rows from the upper edge, little-endian.
 * `milliseconds` is how long it was drawn. With several `eyes` rows of colours and depths are
 * those of all of them, one eye after the other; `size` is that of each.
 *
 * `coding` "raw": `colours` are linear RGB multiplied by opacity, and opacity, as float16,
 * shape [rows, columns, 4]; `depths` distances from the eye along the direction of view as
 * uint16 from `nearest` (0) to `farthest` (32766) [mm], 32768 more where all of a ray is seen
 * through: there what is seen lies about so deep; 65535 where nothing is; shape [rows, columns].
 *
 * `coding` "webp": `colours` is a WebP picture of twice as many rows, above the same RGB
 * divided by `brightest`, as sRGB, below opacity as grey. `depths` are those of every
 * `depth_every`-th pixel of every `depth_every`-th row, less that to their left (modulo
 * 65536); first all low bytes, then all high ones, deflated (RFC 1950).
 */
export interface DrawnPicture {
  readonly type: "drawn_picture";
  readonly number: number;
  readonly size: readonly [number, number];
  readonly eyes: number;
  readonly part: readonly [number, number] | null;
  readonly over: number | null;
  readonly state: number;
  readonly divisor: number;
  readonly samples: number;
  readonly finished: boolean;
  readonly milliseconds: number;
  readonly coding: "raw" | "webp";
  readonly colours: Uint8Array;
  readonly brightest: number;
  readonly depths: Uint8Array;
  readonly depth_every: number;
  readonly nearest: number;
  readonly farthest: number;
}

/**
 * Bytes of a packed `DrawnPicture`, so that states need not wait for all of it.
 *
 * Parts of one `serial` come in order; `last` ends them. Once a part of another comes, the
 * rest of those before never does.
 */
export interface PicturePart {
  readonly type: "picture_part";
  readonly serial: number;
  readonly last: boolean;
  readonly packed: Uint8Array;
}

/** Tells that the pictures of the `DrawPicture` with this number do not come, and why. */
export interface PictureFailed {
  readonly type: "picture_failed";
  readonly number: number;
  readonly text: string;
}

/**
 * Volumes of the parts that a painted cut would make of segment `id` [ml], larger first.
 *
 * Both are null where the whole segment would be on one side.
 */
export interface CutPreview {
  readonly type: "cut_preview";
  readonly id: SegmentId;
  readonly larger_ml: number | null;
  readonly smaller_ml: number | null;
}

/**
 * An event of a needle at a time [s], in a segment, 0 for none.
 *
 * `depth` is the distance from the point of entry [mm], `force` that at its tip [N].
 */
export interface NeedleEvent {
  readonly kind: NeedleEventKind;
  readonly segment: number;
  readonly time: number;
  readonly depth: number;
  readonly force: number;
}

/** Events of the needle since it was chosen, oldest first; only the newest 100. */
export interface NeedleEvents {
  readonly type: "needle_events";
  readonly events: readonly NeedleEvent[];
}

/** What is being done to segments in the background; null where nothing is. */
export interface SegmentWork {
  readonly type: "segment_work";
  readonly what: string | null;
}

/**
 * Tells of a region that is shown as segment `id` until a person keeps it or not.
 *
 * `level` is how wide its range of values is, from `least` to `most`; `usual` is the one
 * that was found.
 */
export interface Grown {
  readonly type: "grown";
  readonly id: SegmentId;
  readonly level: number;
  readonly usual: number;
  readonly least: number;
  readonly most: number;
  readonly volume_ml: number;
}

/**
 * Tells how many islands segment `id` has, and which of them would go.
 *
 * `preview` is a segment of those that would; null where all stay. `largest_ml` are the
 * volumes of the largest ones, in that order.
 */
export interface Islands {
  readonly type: "islands";
  readonly id: SegmentId;
  readonly preview: SegmentId | null;
  readonly count: number;
  readonly stays: number;
  readonly goes_ml: number;
  readonly largest_ml: readonly number[];
}

/** Tells what would be cut out: `preview` is a segment of it; null where nothing is. */
export interface Scissors {
  readonly type: "scissors";
  readonly preview: SegmentId | null;
  readonly goes_ml: number;
}

/** Tells which segment a table has become, for a person to decide on. */
export interface TableFound {
  readonly type: "table_found";
  readonly id: SegmentId;
}

/** Tells that the scan has a table in it, which is not shown as a segment. */
export interface TableSuggested {
  readonly type: "table_suggested";
}

/**
 * The second scan; null where there is none any more.
 *
 * `second_from_first` maps points of the first scan to the second, row-major, shape [4, 4],
 * patient of each [mm]; its values are at `/api/second` and change with each `version`. It
 * `is_moved` where a transform places it elsewhere than its own geometry does.
 */
export interface SecondScan {
  readonly type: "second_scan";
  readonly scan: Scan | null;
  readonly second_from_first: readonly number[];
  readonly is_moved: boolean;
  readonly version: number;
}

/** The metric after each step on one level of a registration; smaller is better. */
export interface RegistrationLevel {
  readonly name: string;
  readonly values: readonly number[];
}

/**
 * Result of a registration: the metric before and after, and how far points move [mm].
 *
 * `overlap_before` and `overlap` are the fractions of the first scan that the second covers at
 * the start and afterwards; `start_kept` says that the start was right already.
 */
export interface FoundRegistration {
  readonly kind: RegistrationKind;
  readonly metric: RegistrationMetric;
  readonly before: number;
  readonly after: number;
  readonly overlap_before: Share;
  readonly overlap: Share;
  readonly start_kept: boolean;
  readonly moved_mean: number;
  readonly moved_most: number;
}

/**
 * Progress of the registration of the second scan, and the result of the last one.
 *
 * `doing` and `share` are null where none is running, `failure` says why the last one
 * changed nothing; `curve` is that of the current or last one. `steps` counts registrations
 * that can be undone, `undone` those that can be redone. `shown` says whether the second scan
 * is shown before or after `found`.
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
 * Answer to a `Fence`: everything that this page requested before it is done.
 *
 * Touch follows it from `tick` on. Thresholds, growing and changes of shape run in the
 * background and may complete later.
 */
export interface Passed {
  readonly type: "passed";
  readonly number: number;
  readonly tick: number;
}

/** Target to which the hand pulls the device [scene]; latest wins. */
export interface Hand {
  readonly type: "hand";
  readonly target: Vector;
}

/**
 * Presses on what a ray of the scene meets first, with a force [N]; latest wins.
 *
 * The hand brings the probe there, pushes, and follows the next press along the surface.
 */
export interface Press {
  readonly type: "press";
  readonly origin: Vector;
  readonly direction: Vector;
  readonly pressure: number;
}

/** Lifts the hand off what this page presses. */
export interface Lift {
  readonly type: "lift";
}

/** Moves probe, device and hand to a point, or to the nearest free voxel. */
export interface Place {
  readonly type: "place";
  readonly point: Vector;
}

/** Axes of the view in the scene, with which those of the device are aligned (thesis 4.7). */
export interface View {
  readonly type: "view";
  readonly right: Vector;
  readonly up: Vector;
}

/** Factors on the light of the picture; see `palpate.pictures.appearance`. */
export interface LookLight {
  readonly ambient: number;
  readonly diffuse: number;
  readonly specular: number;
  readonly shininess: number;
  readonly edges: Share;
  readonly occlusion: Share;
  readonly shadow: Share;
}

/**
 * A segment that does not look as the scan does.
 *
 * `range` has the limits of the threshold that made it, both included; null where its voxels
 * alone tell.
 */
export interface LookSegment {
  readonly id: SegmentId;
  readonly range: readonly [Value, Value] | null;
  readonly edited: boolean;
  readonly shown: "solid" | "tinted" | "hidden";
  readonly colour: LinearColour;
  readonly ambient: number;
  readonly specular: number;
}

/** A segment whose surface of triangles is drawn, where it stands by then. */
export interface LookSurface {
  readonly id: SegmentId;
  readonly colour: LinearColour;
  readonly opacity: number;
  readonly wireframe: boolean;
  readonly ambient: number;
  readonly specular: number;
}

/**
 * How the second scan is drawn through the first, as `PictureLook` has it of that.
 *
 * `tint` are its colours in modes of grey, `opacity` theirs and that of its iso-surface. By
 * `turns` both are seen, or one of them in cells of an edge of `cells` [mm], or the second.
 */
export interface LookSecond {
  readonly density: number;
  readonly transfer: readonly (readonly [Value, LinearColour, number])[];
  readonly edge_gradient: number;
  readonly window: readonly [Value, Value];
  readonly iso_value: Value;
  readonly iso_colour: LinearColour;
  readonly tissue_from: Value;
  readonly tint: "warm" | "cool" | "grey";
  readonly opacity: Share;
  readonly turns: "together" | "cells" | "second";
  readonly cells: number;
}

/**
 * Sets how the engine's pictures for this page look from now on: all but the camera.
 *
 * `transfer` has value, colour and extinction [1/mm] of each point; `window` width and middle;
 * `slab` is in mm; `clip` has planes, a unit normal toward what is cut away, and
 * `normal · point` of their points [mm]. `second` is null where the second scan is not shown.
 */
export interface PictureLook {
  readonly type: "picture_look";
  readonly mode: "shaded" | "composite" | "absorption" | "emission" | "mip" | "minip" | "average" | "iso";
  readonly density: number;
  readonly transfer: readonly (readonly [Value, LinearColour, number])[];
  readonly edge_gradient: number;
  readonly window: readonly [Value, Value];
  readonly iso_value: Value;
  readonly iso_colour: LinearColour;
  readonly tissue_from: Value;
  readonly slab: number | null;
  readonly lighting: LookLight;
  readonly segments: readonly LookSegment[];
  readonly surfaces: readonly LookSurface[];
  readonly clip: ClipPlanes;
  readonly second: LookSecond | null;
}

/** A camera; see `palpate.pictures.camera` and `camera.ts`. */
export interface SeenFrom {
  readonly target: Vector;
  readonly distance: number;
  readonly right: Vector;
  readonly up: Vector;
  readonly back: Vector;
  readonly field: number;
  readonly parallel: number | null;
  readonly aside: number;
}

/** The picture that a page shows in the same view, size and look; see `DrawnPicture`. */
export interface PictureOver {
  readonly state: number;
  readonly divisor: number;
}

/**
 * Requests pictures of the 3-D view in the last `PictureLook`; see `DrawnPicture`.
 *
 * One at once, with what each of the `cameras` sees: two eyes that look straight ahead, or one.
 * Where the view does not move (`moving`) finer ones follow, until another is
 * requested. `size` has columns and rows [pixels]. The last picture is the mean of `samples`,
 * of `steps_per_voxel` steps for each smallest voxel edge. With `jitter` rays start at
 * different fractions of a step. Where the page shows this view already (`over`) and a part of
 * it was edited since, that part comes first.
 */
export interface DrawPicture {
  readonly type: "draw_picture";
  readonly number: number;
  readonly cameras: readonly SeenFrom[];
  readonly size: readonly [number, number];
  readonly moving: boolean;
  readonly over: PictureOver | null;
  readonly steps_per_voxel: number;
  readonly samples: number;
  readonly jitter: boolean;
}

/** Tells that the next `PicturePart` has arrived, by which the engine measures the way. */
export interface PictureTaken {
  readonly type: "picture_taken";
}

/** Decouples the device from the probe, or couples them again. */
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

/** Makes a segment of each class of values except the lowest, by Otsu's thresholds. */
export interface Otsu {
  readonly type: "otsu";
  readonly classes: number;
}

/**
 * Shows a region of the connected voxels with values like those at `seed`: `Grown` answers.
 *
 * `spread` is half of the range of values, in standard deviations around the seed. Passages
 * narrower than `passage` [mm] are not entered, and the segment becomes no larger than
 * `most_ml`. Where neither is given, both are found: those whose segment ends at an edge.
 */
export interface GrowSegment {
  readonly type: "grow_segment";
  readonly seed: Vector;
  readonly spread: number | null;
  readonly passage: number | null;
  readonly most_ml: number;
}

/** Shows the region of a narrower or wider range: `Grown` answers, if one is shown. */
export interface ChangeGrown {
  readonly type: "change_grown";
  readonly level: number;
}

/** Makes the region that is shown a segment, as one step of undo, or shows it no more. */
export interface EndGrown {
  readonly type: "end_grown";
  readonly keeps: boolean;
}

/**
 * Grows a segment from each seed; they meet where values change most.
 *
 * Values are smoothed by a Gaussian with this standard deviation [mm].
 */
export interface GrowSeeds {
  readonly type: "grow_seeds";
  readonly ids: readonly SegmentId[];
  readonly smoothing: number;
}

/**
 * Changes the shape of a segment; undo takes it back.
 *
 * `amount` is a number of islands to keep, the least volume of islands to keep [ml], or a length
 * [mm]; `other` is the segment to unite, subtract or intersect with.
 */
export interface ChangeShape {
  readonly type: "change_shape";
  readonly id: SegmentId;
  readonly kind: ShapeKind;
  readonly amount: number;
  readonly other: SegmentId | null;
}

/**
 * Shows which islands of a segment would go: `Islands` answers, and nothing is changed yet.
 *
 * At most `most` stay, the largest ones, and none that is smaller than `least_ml`.
 */
export interface ShowIslands {
  readonly type: "show_islands";
  readonly id: SegmentId;
  readonly most: number;
  readonly least_ml: number;
}

/**
 * Shows what a loop on the picture would cut out: `Scissors` answers, and nothing is changed.
 *
 * It is cut out of segment `id`, or of the scan without one. `line` are points below the loop
 * in front of the eye; `view` is the direction of view. What lies inside goes, or `outside`,
 * right through, or less than `depth` [mm] behind the first surface: of the segment, or of all
 * that are shown.
 */
export interface ShowScissors {
  readonly type: "show_scissors";
  readonly id: SegmentId | null;
  readonly line: readonly Vector[];
  readonly eye: Vector;
  readonly view: Vector;
  readonly outside: boolean;
  readonly depth: number | null;
}

/** Removes what `ShowIslands` or `ShowScissors` has shown, as one step of undo, or not. */
export interface EndGoing {
  readonly type: "end_going";
  readonly removes: boolean;
}

/** A step of `Segment.steps` as it is wanted: `index` is where it is there, from 0 on. */
export interface WantedStep {
  readonly index: number;
  readonly kind: StepKind;
  readonly amount: number;
  readonly on: boolean;
}

/** Makes a segment anew by steps of its list, in another order, with other values, or fewer. */
export interface ChangeSteps {
  readonly type: "change_steps";
  readonly id: SegmentId;
  readonly steps: readonly WantedStep[];
}

/** Stops what `SegmentWork` reports and drops what is queued. */
export interface StopSegmentWork {
  readonly type: "stop_segment_work";
}

/** Makes a segment of what lies outside of the body and does not touch it: `TableFound`. */
export interface FindTable {
  readonly type: "find_table";
}

/**
 * Looks for a table beside all else: `TableSuggested` where there is one, else nothing.
 *
 * It gives way to other work on segments, and is not begun while there is some.
 */
export interface SuggestTable {
  readonly type: "suggest_table";
}

/** Takes the table that was suggested out of the scan; undo brings it back. */
export interface RemoveTable {
  readonly type: "remove_table";
}

/** Takes the voxels of a segment out of the scan, and removes the segment: one step of undo. */
export interface RemoveFromScan {
  readonly type: "remove_from_scan";
  readonly id: SegmentId;
}

/**
 * Takes what lies outside of a box out of the scan; undo brings it back.
 *
 * `low` and `high` are how much goes from the low and high faces of the scan, along its own
 * axes [mm]; voxels whose centre lies in the box stay.
 */
export interface CropScan {
  readonly type: "crop_scan";
  readonly low: Vector;
  readonly high: Vector;
}

/**
 * Registers the second scan to the first and moves it there; undo takes that back.
 *
 * Each of `pairs` is a point of the first scan and the same place in the second, in the patient
 * frame of each.
 */
export interface Register {
  readonly type: "register";
  readonly kind: RegistrationKind;
  readonly metric: RegistrationMetric;
  readonly start: RegistrationStart;
  readonly pairs: readonly PointPair[];
}

/** Stops the current registration; nothing is changed then. */
export interface StopRegistration {
  readonly type: "stop_registration";
}

/** Shows the second scan before or after the last registration; no step of undo. */
export interface ShowRegistration {
  readonly type: "show_registration";
  readonly which: "before" | "after";
}

/** Undoes the last registration. */
export interface UndoRegistration {
  readonly type: "undo_registration";
}

/** Redoes the registration that was undone last. */
export interface RedoRegistration {
  readonly type: "redo_registration";
}

/** Adds a segment without voxels, to be painted; undo removes it. */
export interface NewSegment {
  readonly type: "new_segment";
  readonly name: Name;
}

/**
 * Paints voxels of a segment along points, or erases them: a stroke until `EndPaint`.
 *
 * The brush has a radius [mm]. It is a disc in the slice with this `normal`, or a ball without
 * one. Where `values` is given, only voxels with such values are changed.
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

/** Ends a stroke of the brush as one step of undo, or undoes it where it is not kept. */
export interface EndPaint {
  readonly type: "end_paint";
  readonly keep: boolean;
}

/** Requests the path along edges of a slice from one point to another; see `Outline`. */
export interface Wire {
  readonly type: "wire";
  readonly number: number;
  readonly begin: Vector;
  readonly end: Vector;
  readonly normal: Vector;
}

/** Requests the outline through a point of a slice at that point's value; see `Outline`. */
export interface TraceLevel {
  readonly type: "trace_level";
  readonly number: number;
  readonly point: Vector;
  readonly normal: Vector;
}

/**
 * Adds the voxels inside an outline in a slice to a segment, or removes them: one step of undo.
 *
 * Where `values` is given, only voxels with such values are changed.
 */
export interface FillOutline {
  readonly type: "fill_outline";
  readonly id: SegmentId;
  readonly erases: boolean;
  readonly points: readonly Vector[];
  readonly normal: Vector;
  readonly values: readonly [Value, Value] | null;
}

/** Changes the appearance of a segment, and whether it is touchable and locked. */
export interface SegmentProperties {
  readonly type: "segment_properties";
  readonly name: Name;
  readonly colour: Colour;
  readonly visible: boolean;
  readonly touched_while_hidden: boolean;
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

/** Segments that are all shown in the same way; null leaves that of each as it is. */
export interface ShownSegments {
  readonly ids: readonly SegmentId[];
  readonly visible: boolean | null;
  readonly shown_as: ShownAs | null;
}

/** Shows and hides segments, or shows them in another way, all at once. */
export interface ShowSegments {
  readonly type: "show_segments";
  readonly changes: readonly ShownSegments[];
}

/** Changes the touch settings of a segment. */
export interface SegmentFeel {
  readonly type: "segment_feel";
  readonly id: SegmentId;
  readonly feel: Feel;
}

/**
 * Sets the material of a segment, by name or by constants; with neither it is rigid.
 *
 * It is a step of undo where it is `undoable`: what a page sends by itself is not.
 */
export interface SetMaterial {
  readonly type: "set_material";
  readonly id: SegmentId;
  readonly preset: Name | null;
  readonly constants: Constants | null;
  readonly undoable: boolean;
}

/**
 * Sets how regions of a segment deform; the last region that contains a voxel applies to it.
 *
 * Voxels in no region deform.
 */
export interface SetRegions {
  readonly type: "set_regions";
  readonly id: SegmentId;
  readonly regions: readonly MatterRegion[];
}

/**
 * Sets the deformation model and its options; null makes every segment rigid.
 *
 * It is a step of undo where it is `undoable`.
 */
export interface SetDeformation {
  readonly type: "set_deformation";
  readonly model: ModelName | null;
  readonly options: ModelOptions;
  readonly undoable: boolean;
}

/** Sets the source of the force of soft tissue on a tool. */
export interface SetForceSource {
  readonly type: "set_force_source";
  readonly source: ForceSource;
}

/** Starts or stops sending this page the nodes or particles of the model. */
export interface ShowParts {
  readonly type: "show_parts";
  readonly on: boolean;
}

/**
 * Moves a segment to a pose; latest wins, and the servo moves it there smoothly.
 *
 * Moves of a drag that `goes_on` and the one that ends it are one step of undo.
 */
export interface MoveSegment {
  readonly type: "move_segment";
  readonly id: SegmentId;
  readonly pose: Pose;
  readonly goes_on: boolean;
}

/** Attaches a segment to the probe, null releases it; others stop it where it `collides`. */
export interface Grab {
  readonly type: "grab";
  readonly id: SegmentId | null;
  readonly collides: boolean;
}

/** Rotates the attached segment about the probe by a rotation vector [rad]. */
export interface TurnGrabbed {
  readonly type: "turn_grabbed";
  readonly rotation: Vector;
}

/**
 * Splits a segment along a line drawn on the picture, extruded away from the eye.
 *
 * `line` are points below it in front of the eye; `view` is the direction of view. A
 * `closed` line connects its ends, an open one continues straight. The smaller part is a new
 * segment; with `preview` nothing is changed, and `CutPreview` answers.
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

/** Starts measuring the gap between two segments while they move; null stops it. */
export interface WatchGap {
  readonly type: "watch_gap";
  readonly pair: readonly [SegmentId, SegmentId] | null;
}

/**
 * Sets how often the picture follows edits: every so many of its 60 frames a second.
 *
 * Edits in between are shown together. The slowest of several pages sets the pace.
 */
export interface FollowEdits {
  readonly type: "follow_edits";
  readonly every: number;
}

/** Starts recording every input of the servo, or stops it; the file is at `/api/recording`. */
export interface RecordSession {
  readonly type: "record";
  readonly on: boolean;
}

/** Removes a segment; undo restores it. */
export interface RemoveSegment {
  readonly type: "remove_segment";
  readonly id: SegmentId;
}

/** Requests new settings. */
export interface ChangeSettings {
  readonly type: "change_settings";
  readonly settings: Settings;
}

/**
 * Cuts the scene for touch at planes; what lies before one is not felt, nor changed by tools.
 *
 * Each is a unit normal toward what is cut away, and `normal · point` of its points [mm].
 */
export interface ChangeTouchClip {
  readonly type: "change_touch_clip";
  readonly planes: ClipPlanes;
}

/** Requests an answer once all earlier requests of the page are done; `number` is returned. */
export interface Fence {
  readonly type: "fence";
  readonly number: number;
}

/**
 * Chooses the tool for the next strokes: the radius of its ball [mm], and what it changes.
 *
 * The radius of a needle is its own, and `tissues` are those of its segments. A painter adds the
 * touched voxels of segments to the first of them, to `depth` below the surface [mm], or in its
 * whole ball; where it `overlaps`, painted voxels also stay in their segment.
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

/** Sets the direction in which the needle enters, inward; null for that of the push. */
export interface NeedleDirection {
  readonly type: "needle_direction";
  readonly direction: Vector | null;
}

/** Withdraws the needle along the path of its insertion. */
export interface WithdrawNeedle {
  readonly type: "withdraw_needle";
}

/** Begins or ends a stroke of the tool; a stroke is one step of undo. */
export interface Stroke {
  readonly type: "stroke";
  readonly on: boolean;
}

/** Recovers what an earlier session left, or keeps it aside and starts anew. */
export interface Recover {
  readonly type: "recover";
  readonly bring_back: boolean;
}

/**
 * Changes a part, or removes it (null).
 *
 * `after` is the version that the page has seen, 0 for none. If another page has changed the
 * part since, its change stays.
 */
export interface Keep {
  readonly type: "keep";
  readonly name: KeptName;
  readonly value: KeptValue | null;
  readonly after: number;
}

/** Undoes the last step. */
export interface Undo {
  readonly type: "undo";
}

/** Redoes the last undone step. */
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
  | TouchClipChanged
  | HandLed
  | Recovery
  | Notice
  | Kept
  | Gap
  | Outline
  | DrawnPicture
  | PicturePart
  | PictureFailed
  | CutPreview
  | NeedleEvents
  | SegmentWork
  | Grown
  | Islands
  | Scissors
  | TableFound
  | TableSuggested
  | SecondScan
  | Registration
  | Passed;

/** A message of the page. */
export type FromPage =
  | Hand
  | Press
  | Lift
  | Place
  | View
  | PictureLook
  | DrawPicture
  | PictureTaken
  | Clutch
  | Threshold
  | Otsu
  | GrowSegment
  | ChangeGrown
  | EndGrown
  | GrowSeeds
  | ChangeShape
  | ShowIslands
  | ShowScissors
  | EndGoing
  | ChangeSteps
  | StopSegmentWork
  | FindTable
  | SuggestTable
  | RemoveTable
  | RemoveFromScan
  | CropScan
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
  | ShowSegments
  | SegmentFeel
  | SetMaterial
  | SetRegions
  | SetDeformation
  | SetForceSource
  | ShowParts
  | MoveSegment
  | Grab
  | TurnGrabbed
  | CutAlong
  | WatchGap
  | FollowEdits
  | RecordSession
  | RemoveSegment
  | ChangeSettings
  | ChangeTouchClip
  | Fence
  | Tool
  | NeedleDirection
  | WithdrawNeedle
  | Stroke
  | Recover
  | Keep
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

const isClipPlanes = list(tuple(isVector, isCoordinate));

const isValue = real({ ge: -1000000000, le: 1000000000 });

const isName = text({ ge: 1, le: 100 });

const isKeptName = text({ ge: 1, le: 80 });

const isKeptValue = text({ ge: 1, le: 65536 });

const isSegmentId = whole({ ge: 1, le: 255 });

const isShare = real({ ge: 0, le: 1 });

const isColour = tuple(isShare, isShare, isShare);

const isStiffness = real({ gt: 0, le: 10 });

const isFriction = real({ ge: 0, le: 2 });

const isShownAs = oneOf("volume", "surface", "both");

const isSurfaceSource = oneOf("intensities", "bits");

const isLightFactor = real({ ge: 0, le: 3 });

const isSmoothingDegree = whole({ ge: 0, le: 12 });

const isStepKind = oneOf("keep-largest", "drop-small", "fill-holes", "between-slices", "grow", "shrink", "smooth", "median", "joint", "open", "close", "hollow-inside", "hollow-outside", "unite", "subtract", "intersect", "by-hand");

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
  identity: text(),
  patient: text(),
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
  volume: nullable(tuple(whole(), whole())),
  rereadable: flag,
  no_dicom: nullable(text()),
  orientation_known: flag,
  warnings: list(text()),
  notes: list(text()),
});

const isKeptPart = record({
  name: isKeptName,
  version: whole(),
  value: nullable(isKeptValue),
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
  fracture_energy: nullable(real({ gt: 0, le: 1000000 })),
  friction: real({ ge: 0, le: 10 }),
  stiffening: real({ ge: 0, le: 100 }),
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

const isSegmentStep = record({
  kind: isStepKind,
  amount: real(),
  other: nullable(text()),
  on: flag,
});

const isSegmentSteps = record({
  range: nullable(tuple(isValue, isValue)),
  steps: list(isSegmentStep),
});

const isSegment = record({
  name: isName,
  colour: isColour,
  visible: flag,
  touched_while_hidden: flag,
  shown_as: isShownAs,
  opacity: isShare,
  smoothing: isSmoothingDegree,
  surface_from: isSurfaceSource,
  wireframe: flag,
  ambient: isLightFactor,
  specular: isLightFactor,
  id: isSegmentId,
  touchable: flag,
  felt: flag,
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
  steps: nullable(isSegmentSteps),
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
  whole_segment: flag,
});

const isHello = record({
  type: oneOf("hello"),
  protocol: whole(),
  version: text(),
  scan: isScan,
  kept: list(isKeptPart),
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
  entry: isVector,
  direction: isVector,
  segment: whole(),
  tip: real(),
  friction: real(),
  wall: real(),
  events: whole(),
  set_direction: nullable(isVector),
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
  whole_segment: flag,
});

const isMatterState = record({
  model: nullable(isModelName),
  options: isModelOptions,
  force_source: isForceSource,
  force: isVector,
  answers: whole(),
  late: flag,
  settling: flag,
  small_box: flag,
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
  displaced: nullable(list(isDisplaced)),
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

const isTouchClipChanged = record({
  type: oneOf("touch_clip_changed"),
  planes: isClipPlanes,
});

const isHandLed = record({
  type: oneOf("hand_led"),
  opened: nullable(text()),
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

const isKept = record({
  type: oneOf("kept"),
  part: isKeptPart,
  answers: flag,
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

const isDrawnPicture = record({
  type: oneOf("drawn_picture"),
  number: whole(),
  size: tuple(whole(), whole()),
  eyes: whole(),
  part: nullable(tuple(whole(), whole())),
  over: nullable(whole()),
  state: whole(),
  divisor: real(),
  samples: whole(),
  finished: flag,
  milliseconds: real(),
  coding: oneOf("raw", "webp"),
  colours: bytes,
  brightest: real(),
  depths: bytes,
  depth_every: whole(),
  nearest: real(),
  farthest: real(),
});

const isPicturePart = record({
  type: oneOf("picture_part"),
  serial: whole(),
  last: flag,
  packed: bytes,
});

const isPictureFailed = record({
  type: oneOf("picture_failed"),
  number: whole(),
  text: text(),
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

const isGrown = record({
  type: oneOf("grown"),
  id: isSegmentId,
  level: whole({ ge: 0, le: 255 }),
  usual: whole({ ge: 0, le: 255 }),
  least: whole({ ge: 0, le: 255 }),
  most: whole({ ge: 0, le: 255 }),
  volume_ml: real(),
});

const isIslands = record({
  type: oneOf("islands"),
  id: isSegmentId,
  preview: nullable(isSegmentId),
  count: whole(),
  stays: whole(),
  goes_ml: real(),
  largest_ml: list(real()),
});

const isScissors = record({
  type: oneOf("scissors"),
  preview: nullable(isSegmentId),
  goes_ml: real(),
});

const isTableFound = record({
  type: oneOf("table_found"),
  id: isSegmentId,
});

const isTableSuggested = record({
  type: oneOf("table_suggested"),
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
  overlap_before: isShare,
  overlap: isShare,
  start_kept: flag,
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
  ["touch_clip_changed", isTouchClipChanged],
  ["hand_led", isHandLed],
  ["recovery", isRecovery],
  ["notice", isNotice],
  ["kept", isKept],
  ["gap", isGap],
  ["outline", isOutline],
  ["drawn_picture", isDrawnPicture],
  ["picture_part", isPicturePart],
  ["picture_failed", isPictureFailed],
  ["cut_preview", isCutPreview],
  ["needle_events", isNeedleEvents],
  ["segment_work", isSegmentWork],
  ["grown", isGrown],
  ["islands", isIslands],
  ["scissors", isScissors],
  ["table_found", isTableFound],
  ["table_suggested", isTableSuggested],
  ["second_scan", isSecondScan],
  ["registration", isRegistration],
  ["passed", isPassed],
]);
