//! The tool in the hand: what it does from press to release, for the simulation.
//!
//! Frame: scene. Where the chosen segments were moved, the tool works in their own frame, that
//! of the first one; segments that stand elsewhere, or on another grid, are passed over, and a
//! drill spares them. Those that are locked are passed over too, and so is what is cut away from
//! touch.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3};
use palpate_haptics::needle::tissues::Tissues;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::stroke::Stroke;
use palpate_tools::tool::{Tool, ToolInput, ToolReport};
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::segment::Segment;
use palpate_volume::voxels::VoxelsError;

use crate::error::SessionError;
use crate::scene::{Scene, Step, ToolStatus};
use crate::servo::ServoStatus;
use crate::touch::ThresholdRange;

/// The probe as the servo last told of it.
#[derive(Clone, Copy, Debug)]
pub struct ProbeStatus {
    /// Where it is [mm].
    pub point: DVec3,
    /// When [s].
    pub time: f64,
    /// Radius of its body [mm].
    pub radius: f64,
    /// Out of what it touches; zero without contact.
    pub normal: DVec3,
    /// Force that has pressed, over time since the servo's start [N·s].
    pub pressed: f64,
}

impl ProbeStatus {
    /// What the servo says.
    #[must_use]
    pub fn of(status: &ServoStatus) -> Self {
        Self {
            point: status.proxy,
            time: status.time,
            radius: status.radius,
            normal: if status.contact {
                status.normal
            } else {
                DVec3::ZERO
            },
            pressed: status.pressed,
        }
    }
}

/// A tool that was pressed.
#[derive(Debug)]
struct Pressed {
    tool: Box<dyn Tool>,
    kind: ToolKind,
    segments: Vec<SegmentId>,
    /// The probe in the last pass.
    last: Option<ProbeStatus>,
}

/// The chosen tool and its stroke.
#[derive(Debug, Default)]
pub struct ToolStroke {
    settings: Option<ToolSettings>,
    pressed: Option<Pressed>,
    changes: Stroke,
    /// The thresholds of changed segments before the stroke.
    ranges: BTreeMap<SegmentId, Option<ThresholdRange>>,
    report: ToolReport,
}

impl ToolStroke {
    /// Whether the probe is as large as a tool is: at any work, and with a drill, which cuts a hole
    /// of that size, also before.
    #[must_use]
    pub fn sets_the_size(&self) -> bool {
        let is_drill = |settings: &ToolSettings| settings.kind == ToolKind::Drill;
        self.is_on() || self.settings.as_ref().is_some_and(is_drill)
    }

    /// Chooses a tool, or none.
    pub fn set_tool(&mut self, settings: Option<ToolSettings>) {
        self.settings = settings;
    }

    /// Presses the chosen tool; gives how many of its segments it passes over. One that is
    /// pressed already goes on.
    ///
    /// # Errors
    /// Where none is chosen, or it does not fit the scan.
    pub fn begin(&mut self, scene: &Scene) -> Result<usize, SessionError> {
        if self.pressed.is_some() {
            return Ok(0);
        }
        let mut settings = self.settings.clone().ok_or(SessionError::NoTool)?;
        let chosen = settings.segments.len();
        if settings.kind == ToolKind::Drill {
            let own = |id: SegmentId| scene.voxels().segment(id).and_then(Segment::own_grid);
            settings.segments.retain(|id| own(*id).is_none());
            if settings.segments.is_empty() && chosen > 0 {
                return Err(SessionError::NothingToDrill);
            }
        }
        // a needle changes nothing
        if settings.kind != ToolKind::Needle {
            pass_over_locked(scene, &mut settings)?;
        }
        let pose = pose_of(scene, &settings.segments);
        let first = settings.segments.first().copied();
        let grid = first.map_or(*scene.voxels().grid(), |id| *scene.voxels().grid_of(id));
        let stands_there =
            |id: SegmentId| placement(scene, id) == pose && *scene.voxels().grid_of(id) == grid;
        // a needle works where the scan has its segments, each by its own
        if settings.kind != ToolKind::Needle {
            settings.segments.retain(|id| stands_there(*id));
        }
        if settings.kind == ToolKind::Painter && settings.segments.len() < 2 && chosen > 1 {
            return Err(SessionError::NothingToPaint);
        }
        let all = scene.segments().map(|(id, ..)| id);
        settings.spared = all.filter(|id| !stands_there(*id)).collect();
        settings.cut_away = scene.clip().mask(&grid, pose);
        self.pressed = Some(Pressed {
            tool: settings.build(&grid)?,
            kind: settings.kind,
            last: None,
            segments: settings.segments,
        });
        self.report = ToolReport::default();
        Ok(chosen
            - self
                .pressed
                .as_ref()
                .map_or(0, |pressed| pressed.segments.len()))
    }

    /// What a needle that is pressed can puncture; none where no needle is.
    #[must_use]
    pub fn needle(&self) -> Option<Tissues> {
        let pressed = self.pressed.as_ref()?;
        let settings = self.settings.as_ref()?;
        let numbers = settings.segments.iter().map(|id| id.0);
        let tissues = || Tissues::of(numbers.zip(settings.tissues.iter().copied()));
        (pressed.kind == ToolKind::Needle).then(tissues)
    }

    /// What the probe's way since the last pass changes; nothing without a stroke.
    ///
    /// # Errors
    /// Where a chosen segment is gone.
    pub fn advance(
        &mut self,
        scene: &Scene,
        probe: &ProbeStatus,
    ) -> Result<Option<Edit>, VoxelsError> {
        let Some(pressed) = &mut self.pressed else {
            return Ok(None);
        };
        let before = pressed.last.replace(*probe).unwrap_or(*probe);
        let dt = probe.time - before.time;
        let is_obstacle = |id: &SegmentId| scene.properties_of(*id).touchable;
        // what drill and painter reach follows from where the body touches
        let by_touch = matches!(pressed.kind, ToolKind::Drill | ToolKind::Painter);
        let has_body = by_touch || pressed.segments.iter().any(is_obstacle);
        let input = ToolInput {
            from: before.point,
            to: probe.point,
            body_radius: has_body.then_some(probe.radius),
            // the mean of all ticks since then
            force: if dt > 0.0 {
                (probe.pressed - before.pressed) / dt
            } else {
                0.0
            },
            contact_normal: probe.normal,
            dt,
        };
        let scan_from_scene = pose_of(scene, &pressed.segments).inverse();
        let edit = pressed
            .tool
            .advance(scene.voxels(), &input.moved(&scan_from_scene));
        self.report = pressed.tool.report();
        edit
    }

    /// Takes the inverse of an edit that was performed.
    pub fn note(&mut self, inverse: Step) {
        let Step::Edit { edit, ranges } = inverse else {
            unreachable!("an edit is undone by an edit");
        };
        self.changes.add(edit);
        for (id, range) in ranges {
            self.ranges.entry(id).or_insert(range);
        }
    }

    /// Whether the stroke has changed anything that is no step yet.
    #[must_use]
    pub fn has_changed(&self) -> bool {
        !self.changes.is_empty()
    }

    /// Whether a tool is pressed.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.pressed.is_some()
    }

    /// The step that takes back what the stroke has changed since this was last asked.
    pub fn take_inverse(&mut self) -> Option<Step> {
        let ranges = std::mem::take(&mut self.ranges);
        let changes = std::mem::take(&mut self.changes);
        (!changes.is_empty()).then(|| Step::Edit {
            edit: changes.into_inverse(),
            ranges: ranges.into_iter().collect(),
        })
    }

    /// The probe jumps: the way there is no part of the stroke.
    pub fn lift(&mut self) {
        if let Some(pressed) = &mut self.pressed {
            pressed.last = None;
            pressed.tool.release();
        }
    }

    /// Releases the tool.
    pub fn end(&mut self) {
        self.lift();
        self.pressed = None;
    }

    /// What the picture shows of it.
    #[must_use]
    pub fn now(&self) -> ToolStatus {
        ToolStatus {
            kind: self.settings.as_ref().map(|settings| settings.kind),
            radius: self
                .settings
                .as_ref()
                .map_or(0.0, |settings| settings.radius),
            on: self.pressed.is_some(),
            report: self.report,
        }
    }

    /// What the tool has done since it was pressed last.
    #[must_use]
    pub fn report(&self) -> ToolReport {
        self.report
    }
}

/// Leaves out what is locked; refuses where that is all, or what a painter paints with.
fn pass_over_locked(scene: &Scene, settings: &mut ToolSettings) -> Result<(), SessionError> {
    let is_locked = |id: &SegmentId| scene.properties_of(*id).locked;
    let needed = match settings.kind {
        ToolKind::Painter => 1,
        _ => settings.segments.len(),
    };
    let refused = settings.segments.iter().take(needed);
    if let Some(first) = settings.segments.first()
        && refused.clone().all(is_locked)
    {
        return Err(SessionError::Locked(first.0));
    }
    settings.segments.retain(|id| !is_locked(id));
    let all = scene.segments().map(|(id, ..)| id);
    settings.locked = all
        .filter(|id| is_locked(id) && placement(scene, *id) == DAffine3::IDENTITY)
        .collect();
    Ok(())
}

/// Where the first of some segments stands.
fn pose_of(scene: &Scene, segments: &[SegmentId]) -> DAffine3 {
    segments
        .first()
        .map_or(DAffine3::IDENTITY, |id| placement(scene, *id))
}

/// Where a segment stands [mm, from the scan to the scene].
fn placement(scene: &Scene, id: SegmentId) -> DAffine3 {
    scene.properties_of(id).pose.unwrap_or(DAffine3::IDENTITY)
}
