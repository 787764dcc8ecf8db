//! Commands of the simulation and changes of what is solid, in their order, as far as
//! one tick allows.

use glam::DVec3;
use palpate_haptics::admission::nearest_free_in;
use palpate_haptics::soft_contact::SoftContact;
use palpate_haptics::tick::TickState;

use super::ServoLoop;
use crate::servo::channels::ServoCommand;
use crate::servo::inputs::TickInputs;
use crate::touch::{Garbage, Probe};

/// Commands executed per tick, at most, and one change of the occupancy.
pub const MAX_COMMANDS_PER_TICK: usize = 16;

/// How far around a placement's point a free voxel is searched [voxels]. The simulation has
/// found one; this is for changes that are still on their way.
const PLACE_REACH: i32 = 3;

impl ServoLoop {
    /// Executes the commands of the simulation, in their order, as far as one tick allows.
    pub(super) fn execute_commands(&mut self, inputs: &TickInputs) {
        for _ in 0..MAX_COMMANDS_PER_TICK {
            match self.ends.inbox.peek() {
                Ok(ServoCommand::Root { .. } | ServoCommand::Bricks(_)) => {
                    return self.follow_changes();
                }
                // the device must have been read once, so that it can be brought along
                Ok(ServoCommand::Place { .. }) if !inputs.is_read() => return,
                // its tissues are given back
                Ok(ServoCommand::Needle(..)) if !self.occupancy.has_room() => return,
                // what comes after a mark is executed after the state is told
                Ok(ServoCommand::Mark) => return self.execute_next(inputs),
                Ok(_) => self.execute_next(inputs),
                Err(_) => return,
            }
        }
    }

    /// Takes the next command.
    fn pop(&mut self) -> Option<ServoCommand> {
        let command = self.ends.inbox.pop().ok()?;
        self.state.command += 1;
        Some(command)
    }

    /// Takes the change that comes next, where there is room for what it replaces.
    fn follow_changes(&mut self) {
        if !self.occupancy.has_room() {
            return;
        }
        let command = self.pop();
        let mut probe = Probe {
            grid: &self.grid,
            proxy: &mut self.state.touch.proxy,
        };
        match command {
            Some(ServoCommand::Root {
                sequence,
                mut touchable,
            }) => {
                self.state.poses.follow_root(&mut touchable, &self.grid);
                self.moved = true;
                self.state.received = sequence;
                self.occupancy.take_root(sequence, touchable, &mut probe);
            }
            Some(ServoCommand::Bricks(change)) => {
                self.state.received = change.sequence;
                self.occupancy.take_bricks(change, &mut probe);
            }
            // whoever calls has looked
            Some(_) | None => {}
        }
    }

    /// Executes a command that changes no occupancy.
    fn execute_next(&mut self, inputs: &TickInputs) {
        let device = inputs.position_in_device;
        match self.pop() {
            Some(ServoCommand::Place {
                point,
                hand,
                device_too,
            }) => {
                self.state.forgotten_hand = hand;
                self.place(point, device_too.then_some(device));
            }
            Some(ServoCommand::Turn(rotation)) => self.state.mapping.turn(device, rotation),
            Some(ServoCommand::Clutch(on)) => {
                let proxy = self.state.touch.proxy.point();
                let point = self.grid.patient_from_grid().transform_point3(proxy);
                self.state.clutch = on.then_some(point);
                self.state.forgotten_hand = self.state.forgotten_hand.max(inputs.hand.number);
            }
            Some(ServoCommand::Settings(settings)) => {
                self.state.mapping.rescale(device, settings.gain);
                self.state.settings = settings;
                self.occupancy.want_radius(settings.probe_radius);
                self.state.touch.blend.note_new_settings();
            }
            Some(ServoCommand::Feel(id, feel)) => {
                self.state.feels.set(id, feel);
                self.state.touch.blend.note_new_settings();
            }
            Some(ServoCommand::Pose(id, target)) => {
                if let Some((bounds, own_grid)) = self.occupancy.place_of(id) {
                    let grid = own_grid.unwrap_or(&self.grid);
                    self.state.poses.lead(id, target, grid, bounds);
                }
            }
            Some(ServoCommand::DeformableContact(deformable_contact)) => {
                self.state.deformable_contact = deformable_contact;
                let (contact, soft) = (&deformable_contact.contact, &mut self.state.soft);
                if deformable_contact.stays {
                    soft.take_staying(contact.as_ref(), inputs.time);
                } else {
                    soft.take(contact.as_ref(), inputs.time);
                }
            }
            Some(ServoCommand::Needle(on, tissues)) => {
                self.state.needle.hold(on, &tissues);
                self.occupancy.dispose(Garbage::Tissues(tissues));
            }
            Some(ServoCommand::NeedleDirection(direction)) => self.state.needle.aim(direction),
            Some(ServoCommand::Mark) => {
                self.marked = true;
                // a replay knows only what is read from here on
                self.cache.forget();
            }
            // changes of occupancy are taken elsewhere
            Some(ServoCommand::Root { .. } | ServoCommand::Bricks(_)) | None => {}
        }
    }

    /// Brings the probe to a free point, and the device there by moving the mapping.
    fn place(&mut self, point: DVec3, device: Option<DVec3>) {
        let point_in_grid = self.grid.grid_from_patient().transform_point3(point);
        let scene = self.occupancy.scene(&self.grid);
        let Some(proxy) = nearest_free_in(&scene, point_in_grid, PLACE_REACH) else {
            self.state.refused_places += 1;
            return;
        };
        self.state.touch = TickState::new(proxy);
        self.state.needle.forget();
        self.state.soft = SoftContact::default();
        let placed = self
            .grid
            .patient_from_grid()
            .transform_point3(proxy.point());
        self.state.hand = placed;
        self.state.clutch = self.state.clutch.map(|_| placed);
        if let Some(device) = device {
            self.state.mapping.place(device, placed);
        }
    }
}
