//! A scene, how it looks and its light, kept ready for one picture after another.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use glam::{DVec3, Vec3};
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;
use thiserror::Error;

use crate::appearance::{Appearance, Blend, Lighting};
use crate::camera::{Camera, RayFan};
use crate::displaced::Displacements;
use crate::draw::{Request, draw_averaged};
use crate::light_volume::LightVolume;
use crate::part::Part;
use crate::picture::Picture;
use crate::prepared::Prepared;
use crate::scene::{Scene, SceneError};
use crate::second::{SecondAppearance, SecondScan};
use crate::stop::Stop;
use crate::surfaces::SegmentSurface;

/// Cells along the scan's longest edge in which light is worked out.
const LIGHT_CELLS: u32 = 128;

/// Edits whose voxels are remembered: those of some seconds of drilling.
const REMEMBERED: usize = 256;

/// The newest state of any renderer: two renderers have none in common, so that a picture of one is never taken for
/// that of another.
static STATES: AtomicU64 = AtomicU64::new(0);

/// Draws pictures of a scan that is edited meanwhile.
#[derive(Debug)]
pub struct Renderer {
    scene: Scene,
    appearance: Option<Appearance>,
    /// Of the last picture's scene and appearance; none until a picture is asked for.
    prepared: Option<Prepared>,
    /// Voxels that were changed since.
    changed: VoxelBox,
    /// Number of what is drawn; another one with every change of it.
    state: u64,
    /// Of the last changes: the state before each, and the voxels that look different by it.
    edits: VecDeque<(u64, VoxelBox)>,
    second: Option<(Arc<SecondScan>, SecondAppearance)>,
    /// The mode for which the second scan was made ready; none where it is not.
    second_in: Option<Blend>,
    light: Option<LightVolume>,
    stale: Stale,
    /// Toward the lamp for which the light was worked out, patient frame.
    lamp: DVec3,
}

/// A picture was asked for before an appearance was given.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("no appearance given; allowed: one, before the first picture")]
pub struct NoAppearance;

/// What of the light is not that of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stale {
    Nothing,
    Around(VoxelBox),
    Everything,
}

impl Renderer {
    /// Reads each value once.
    ///
    /// # Errors
    /// Where there are too many voxels.
    pub fn new(voxels: Voxels) -> Result<Self, SceneError> {
        Ok(Self {
            scene: Scene::new(voxels)?,
            appearance: None,
            prepared: None,
            changed: VoxelBox::EMPTY,
            state: next_state(),
            edits: VecDeque::new(),
            second: None,
            second_in: None,
            light: None,
            stale: Stale::Everything,
            lamp: DVec3::ZERO,
        })
    }

    /// The edit whose voxels are drawn.
    #[must_use]
    pub fn edit_number(&self) -> u64 {
        self.scene.voxels().edit_number()
    }

    /// Takes the voxels of a later edit of the same scan; returns whether anything had changed.
    pub fn follow(&mut self, voxels: Voxels) -> bool {
        if voxels.edit_number() == self.edit_number() {
            return false;
        }
        let changed = self.scene.follow(voxels);
        self.remember(changed);
        self.stale = match self.stale {
            Stale::Nothing => Stale::Around(changed),
            Stale::Around(before) => Stale::Around(before.union(&changed)),
            Stale::Everything => Stale::Everything,
        };
        self.changed = self.changed.union(&changed);
        true
    }

    /// Has tissue stand beside its voxels by all of these together; without any: in them. Light is that of the voxels.
    ///
    /// # Panics
    /// Where there is no node, or not one displacement for each.
    pub fn displace(&mut self, displacements: &[Displacements<'_>]) {
        let changed = self.scene.displace(displacements);
        self.remember(changed);
    }

    /// Number of what is drawn now, see [`Self::part_edited_since`].
    #[must_use]
    pub fn state(&self) -> u64 {
        self.state
    }

    /// The part of a picture that shows what has changed of voxels, displacements and triangles since this state; none
    /// where that is not known, or where more may look different.
    #[must_use]
    pub fn part_edited_since(&self, state: u64, camera: &Camera, size: (u32, u32)) -> Option<Part> {
        let voxels = self.edited_since(state)?;
        let fan = RayFan::new(camera, self.scene.grid(), size);
        Some(Part::showing(&voxels, &fan))
    }

    fn edited_since(&self, state: u64) -> Option<VoxelBox> {
        if state == self.state {
            return Some(VoxelBox::EMPTY);
        }
        let since = self.edits.iter().position(|&(before, _)| before == state)?;
        let edits = self.edits.range(since..);
        Some(edits.fold(VoxelBox::EMPTY, |all, (_, changed)| all.union(changed)))
    }

    /// Something else has changed than edits tell.
    fn forget_edits(&mut self) {
        self.edits.clear();
        self.state = next_state();
    }

    fn remember(&mut self, changed: VoxelBox) {
        self.edits.push_back((self.state, changed));
        self.state = next_state();
        if self.edits.len() > REMEMBERED {
            self.edits.pop_front();
        }
    }

    /// Takes the surfaces of segments as they are now.
    pub fn set_surfaces(&mut self, surfaces: Vec<SegmentSurface>) {
        let at_rest = |all: &[SegmentSurface]| -> Vec<u8> {
            let there = all.iter().filter(|it| it.is_at_rest());
            there.map(|it| it.id).collect()
        };
        // what they shade follows from their segments' voxels
        if at_rest(&self.scene.surfaces) != at_rest(&surfaces) {
            self.stale = Stale::Everything;
        }
        match self.scene.set_surfaces(surfaces) {
            Some(changed) if changed.is_empty() => {}
            Some(changed) => self.remember(changed),
            None => self.forget_edits(),
        }
    }

    /// Shows the scan in another way.
    pub fn set_appearance(&mut self, appearance: Appearance) {
        match &self.appearance {
            Some(before) if *before == appearance => return,
            Some(before) if is_as_opaque(before, &appearance) => {}
            _ => self.stale = Stale::Everything,
        }
        self.appearance = Some(appearance);
    }

    /// Shows a second scan through the first; none: the first alone.
    pub fn show_second(&mut self, shown: Option<(Arc<SecondScan>, SecondAppearance)>) {
        let is_same = match (&self.second, &shown) {
            (Some(before), Some(now)) => Arc::ptr_eq(&before.0, &now.0) && before.1 == now.1,
            (before, now) => before.is_none() && now.is_none(),
        };
        if !is_same {
            self.second = shown;
            self.second_in = None;
            self.forget_edits();
        }
    }

    /// Draws the mean of so many pictures; none where `stop` said so meanwhile. A picture in haste, and a part of one,
    /// are lit by the light of the one before.
    ///
    /// # Errors
    /// Where nobody has said how the scan looks.
    pub fn draw(
        &mut self,
        request: &Request,
        samples: u32,
        stop: Stop<'_>,
    ) -> Result<Option<Picture>, NoAppearance> {
        let appearance = self.appearance.clone().ok_or(NoAppearance)?;
        if self.second_in != Some(appearance.blend) {
            let shown = self.second.clone();
            self.scene.show_second(shown, appearance.blend);
            self.second_in = Some(appearance.blend);
        }
        self.prepare(appearance);
        Ok(self.draw_prepared(request, samples, stop))
    }

    /// Brings what the pictures have in common to the scene and the appearance as they are.
    fn prepare(&mut self, appearance: Appearance) {
        // none is left if this panics
        let prepared = match self.prepared.take() {
            Some(mut prepared) => {
                prepared.follow(&self.scene, &self.changed);
                prepared.show(&self.scene, appearance);
                prepared
            }
            None => Prepared::new(&self.scene, appearance),
        };
        self.prepared = Some(prepared);
        self.changed = VoxelBox::EMPTY;
    }

    fn draw_prepared(
        &mut self,
        request: &Request,
        samples: u32,
        stop: Stop<'_>,
    ) -> Option<Picture> {
        if !request.is_in_haste && request.part.is_none() {
            self.bring_light(request.camera.lamp(), stop)?;
        }
        let prepared = self.prepared.as_ref()?;
        let light = self.light.as_ref();
        draw_averaged(&self.scene, prepared, light, request, samples, stop)
    }

    /// Works out what of the light is not that of the scene; none where `stop` said so meanwhile.
    fn bring_light(&mut self, lamp: DVec3, stop: Stop<'_>) -> Option<()> {
        let (scene, prepared) = (&self.scene, self.prepared.as_ref()?);
        let Lighting {
            occlusion, shadow, ..
        } = prepared.appearance().lighting;
        if !prepared.appearance().blend.is_lit() || (occlusion <= 0.0 && shadow <= 0.0) {
            return Some(());
        }
        // the light before is kept until another is whole, for pictures in haste
        let followed = match (&self.light, self.stale) {
            (Some(_), Stale::Nothing) => None,
            (Some(light), Stale::Around(changed)) => {
                Some(light.follow(scene, prepared, &changed, stop)?)
            }
            _ => {
                let light = LightVolume::new(scene, prepared, lamp, LIGHT_CELLS, stop)?;
                self.lamp = lamp;
                Some(light)
            }
        };
        if followed.is_some() {
            self.light = followed;
            self.stale = Stale::Nothing;
        }
        if shadow > 0.0 && lamp.distance_squared(self.lamp) > 1e-8 {
            let light = self.light.as_ref()?;
            self.light = Some(light.turn_lamp(scene, prepared, lamp, stop)?);
            self.lamp = lamp;
        }
        Some(())
    }
}

fn next_state() -> u64 {
    STATES.fetch_add(1, Relaxed) + 1
}

/// Whether all places let as much light through; other colours and lights change nothing of that.
fn is_as_opaque(one: &Appearance, other: &Appearance) -> bool {
    without_colours(one) == without_colours(other)
}

/// What of an appearance tells how opaque places are.
fn without_colours(appearance: &Appearance) -> Appearance {
    let mut opacity = appearance.clone();
    opacity.lighting = Lighting {
        edges: appearance.lighting.edges,
        ..Lighting::default()
    };
    opacity.iso_colour = Vec3::ZERO;
    for point in &mut opacity.transfer {
        point.colour = Vec3::ZERO;
    }
    for surface in &mut opacity.surfaces {
        (surface.colour, surface.ambient, surface.specular) = (Vec3::ZERO, 1.0, 1.0);
    }
    for segment in &mut opacity.segments {
        (segment.colour, segment.ambient, segment.specular) = (Vec3::ZERO, 1.0, 1.0);
    }
    opacity
}

#[cfg(test)]
mod tests {
    use super::is_as_opaque;
    use crate::appearance::{Appearance, Blend, ControlPoint, Lighting, Shown, ShownSegment};
    use glam::Vec3;

    fn appearance() -> Appearance {
        let point = |value, extinction| ControlPoint {
            value,
            colour: Vec3::ONE,
            extinction,
        };
        Appearance {
            blend: Blend::Shaded,
            density: 1.0,
            transfer: vec![point(0.0, 0.0), point(100.0, 1.0)],
            edge_gradient: 10.0,
            window: (100.0, 50.0),
            iso_value: 50.0,
            iso_colour: Vec3::ONE,
            tissue_from: 20.0,
            slab: None,
            lighting: Lighting::default(),
            segments: vec![ShownSegment {
                id: 1,
                range: None,
                is_edited: false,
                shown: Shown::Solid,
                colour: Vec3::ONE,
                ambient: 1.0,
                specular: 1.0,
            }],
            surfaces: Vec::new(),
            clip: Vec::new(),
        }
    }

    #[test]
    fn colours_and_lights_keep_the_light_and_opacities_do_not() {
        let first = appearance();
        let mut coloured = appearance();
        coloured.segments[0].colour = Vec3::X;
        coloured.segments[0].specular = 2.0;
        coloured.transfer[1].colour = Vec3::Y;
        coloured.lighting.diffuse = 0.5;
        assert!(is_as_opaque(&first, &coloured));

        let changes: [fn(&mut Appearance); 4] = [
            |it| it.transfer[1].extinction = 2.0,
            |it| it.segments[0].shown = Shown::Hidden,
            |it| it.lighting.edges = 0.5,
            |it| it.density = 2.0,
        ];
        for change in changes {
            let mut other = appearance();
            change(&mut other);
            assert!(!is_as_opaque(&first, &other), "{other:?}");
        }
    }
}
