//! A fault on purpose, only in builds with the feature `planted-fault`, which no usual build has.
//!
//! Walls give way: a probe that is pressed in by more than [`GIVES_WAY`] stands in the solid voxel
//! that held it back. So guarantee 1 is really broken, in every session and every benchmark of
//! such a build, and tests can see that the checks notice. What comes out still follows from the
//! inputs alone, so that a case is replayed.
//!
//! Frame: the world's grid.

use glam::DVec3;
use palpate_haptics::contact::{Contact, Proxy};
use palpate_haptics::scene::TouchScene;

/// How deep the device must be behind the probe [smallest spacings].
const GIVES_WAY: f64 = 2.0;

/// Puts the proxy into the wall before it, where the device presses hard.
pub fn let_walls_give_way<O>(
    scene: &TouchScene<'_, O>,
    device_in_grid: DVec3,
    proxy: &mut Proxy,
    contact: &Contact,
) {
    let depth = ((device_in_grid - proxy.point()) * scene.grid.spacing()).length();
    let is_pressed = depth > GIVES_WAY * scene.grid.smallest_spacing();
    // the world is body 0; an object's voxels are those of another grid
    let wall = contact.stopped_by.filter(|solid| solid.body == 0);
    if let Some(wall) = wall.filter(|_| is_pressed) {
        *proxy = Proxy::nearest_in(wall.voxel, device_in_grid);
    }
}
