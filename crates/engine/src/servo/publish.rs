//! What the servo tells at the end of a tick: the force to the device, its status to the
//! simulation, the tick to the picture.

use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use palpate_haptics::force::LocalForce;
use palpate_haptics::needle::press::Press;
use palpate_haptics::tick::TickOutput;

use super::ServoLoop;
use crate::servo::channels::{ForceCommand, ServoStatus, Snapshot, TickRecord};
use crate::servo::inputs::TickInputs;
use crate::servo::mapping::Mapping;
use crate::touch::NeedleStatus;

impl ServoLoop {
    pub(super) fn publish_force(&mut self, inputs: &TickInputs, output: &TickOutput) {
        let mapping = &self.state.mapping;
        self.ends.forces.write(ForceCommand {
            time: inputs.time,
            tick: self.state.tick + 1,
            law: law_in_device(mapping, inputs, output),
            hand_in_device: mapping.point_to_device(self.state.hand),
            max_force: self.state.settings.force_limit,
        });
    }

    /// Where tissue meets the tool: where the spring's end goes over to, and not where it is on that way, or
    /// answers would tell of the way and the way follow the answers. Beside what does not give way, its end.
    fn tool(&self, inputs: &TickInputs, output: &TickOutput) -> DVec3 {
        self.aimed.unwrap_or_else(|| {
            if self.state.soft.is_felt() {
                self.device_in_scene(inputs) + output.spring
            } else {
                output.contact_point_in_scene
            }
        })
    }

    /// Before the status, so that who reads that one finds poses as new.
    pub(super) fn publish_poses(&mut self) {
        if std::mem::take(&mut self.moved) {
            self.ends.poses.write(self.state.poses.current());
        }
    }

    /// While a needle is felt, and once more when it no longer is; before the status, as poses.
    pub(super) fn publish_needle(&mut self, press: Option<Press>) {
        let is_felt = self.state.needle.is_felt();
        if std::mem::replace(&mut self.had_needle, is_felt) || is_felt {
            let status = NeedleStatus::of(&self.state.needle, press);
            self.ends.needle.write(status);
        }
    }

    /// Adds what presses in this tick. While forces are off nothing does: nobody feels it.
    pub(super) fn note_pressure(
        &mut self,
        inputs: &TickInputs,
        output: &TickOutput,
        sent_in_device: DVec3,
    ) {
        let last = std::mem::replace(&mut self.last_time, inputs.time);
        let dt = inputs.time - last;
        if sent_in_device != DVec3::ZERO && dt > 0.0 {
            let force = output.pressing_force().min(self.state.settings.force_limit);
            self.pressed += force * dt;
        }
    }

    pub(super) fn publish_status(
        &mut self,
        inputs: &TickInputs,
        output: &TickOutput,
        sent_in_device: DVec3,
    ) {
        self.ends.status.write(ServoStatus {
            received: self.state.received,
            held_root: self.occupancy.held_root(),
            held_edits: self.occupancy.held_edits(),
            skipped: self.occupancy.skipped(),
            stopped: self.state.poses.stopped(),
            refused_places: self.state.refused_places,
            radius: self.state.radius,
            device: self.device_in_scene(inputs),
            proxy: output.proxy_in_scene,
            tool: self.tool(inputs, output),
            contact: output.contact,
            touched: self.state.touched,
            time: inputs.time,
            normal: output.normal,
            sent_force: sent_in_device.length(),
            pressed: self.pressed,
            axes: self.state.mapping.rotation,
            orientation: inputs.orientation,
            origin: self.state.mapping.offset,
            command: self.state.command,
        });
    }

    pub(super) fn record(
        &mut self,
        inputs: &TickInputs,
        output: &TickOutput,
        sent_in_device: DVec3,
    ) {
        let recorded = self.ends.records.push(TickRecord {
            tick: self.state.tick,
            time: inputs.time,
            device: self.device_in_scene(inputs),
            hand: self.state.hand,
            proxy: output.proxy_in_scene,
            contact_point: output.contact_point_in_scene,
            normal: output.normal,
            force: output.force,
            sent_force: self.state.mapping.force_to_scene(sent_in_device),
            contact: output.contact,
            depth: output.depth,
            visits: output.visits,
            inputs: *inputs,
            command: self.state.command,
        });
        if recorded.is_err() {
            self.shared.counters.lost_records.fetch_add(1, Relaxed);
        }
    }

    /// Tells the state between this tick and the next, where it was asked for.
    pub(super) fn publish_snapshot(&mut self) {
        if !self.marked {
            return;
        }
        self.marked = false;
        let snapshot = Snapshot {
            state: self.state,
            held: self.occupancy.holds_back(),
        };
        // whoever asks asks once, and takes what he asked for
        let _ = self.ends.snapshots.push(snapshot);
    }
}

/// The contact as the device can follow it.
fn law_in_device(mapping: &Mapping, inputs: &TickInputs, output: &TickOutput) -> LocalForce {
    if output.spring == DVec3::ZERO {
        return LocalForce::held(mapping.force_to_device(output.force));
    }
    LocalForce {
        device: inputs.position_in_device,
        spring: mapping.force_to_device(output.spring),
        normal: mapping.force_to_device(output.normal),
        coupling: output.coupling,
        sticks: output.sticks,
        scale: mapping.scale,
        held: DVec3::ZERO,
    }
}
