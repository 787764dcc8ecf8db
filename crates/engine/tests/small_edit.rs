//! A small edit costs what it changes, however large the scan is and however many segments it has.
//!
//! A binary of its own: its allocator counts what the whole process allocates.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

/// Counts bytes: the only test of this program runs alone.
struct Counting;

static BYTES: AtomicUsize = AtomicUsize::new(0);

// SAFETY: the system's allocator does all of the work.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        BYTES.fetch_add(layout.size(), Relaxed);
        // SAFETY: as the caller promises
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn an_edit_of_one_voxel_copies_no_directory_of_bricks() {
    const DIMENSIONS: UVec3 = UVec3::splat(256);
    let bricks = 32 * 32 * 32;
    let mut rig = Rig::new(DIMENSIONS, DVec3::splat(-5.0));
    let ids = [(); 6].map(|()| {
        let segment = Segment::empty(DIMENSIONS);
        rig.simulation
            .add_segment(segment, OBSTACLE, false)
            .unwrap()
    });
    for _ in 0..10 {
        rig.tick_at(DVec3::splat(-5.0));
        rig.simulation.step();
    }
    let voxel = VoxelBox::new(IVec3::splat(100), IVec3::splat(101));

    let before = BYTES.load(Relaxed);
    rig.simulation.fill_box(ids[0], &voxel, true).unwrap();
    let taken = BYTES.load(Relaxed) - before;

    // one directory is a pointer per brick; the edit, its inverse and its way take a few KB
    assert!(taken < bricks * size_of::<usize>() / 4, "{taken} bytes");
    rig.tick_at(DVec3::splat(-5.0));
    assert!(rig.servo.solid().is_solid(IVec3::splat(100)));
}
