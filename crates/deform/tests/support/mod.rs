//! Bodies and tools that tests of the lattice share. Spacing 1 mm, E = 1 N/mm².
use glam::{DVec3, IVec3, UVec3};
use palpate_deform::lattice::{
    Border, Lattice, LatticeTool, NodeMaterial, RelaxReport, RelaxSettings, Relaxer,
};
use palpate_deform::material::{Solid, SolidSi};

/// E = 1 N/mm², never breaks.
pub fn solid(poisson: f64) -> Solid {
    let si = SolidSi {
        young: 1e6,
        poisson,
        density: 1000.0,
        fracture_energy: f64::INFINITY,
        friction: 0.0,
        stiffening: 0.0,
    };
    si.checked().expect("a solid")
}

/// A block of nodes, nothing around it.
pub fn block(size: UVec3, solid: Solid) -> Lattice {
    let inside =
        move |node: IVec3| node.cmpge(IVec3::ZERO).all() && node.cmplt(size.as_ivec3()).all();
    Lattice::new(size, 1.0, Border::Free, |node| match inside(node) {
        true => NodeMaterial::Deformable(solid),
        false => NodeMaterial::Empty,
    })
}

/// The middle of a box of `count` nodes along each axis.
pub fn middle(count: u32) -> DVec3 {
    DVec3::splat(f64::from(count / 2))
}

/// Half a box of tissue under a plane through its middle, `depth` layers of it over `below`.
pub fn half_space(count: u32, endless: bool, above: Solid, depth: i32, below: Solid) -> Lattice {
    let top = count as i32 / 2;
    let border = match endless {
        true => Border::Endless {
            load: middle(count),
        },
        false => Border::Held,
    };
    Lattice::new(UVec3::splat(count), 1.0, border, |node| {
        if node.z > top {
            NodeMaterial::Empty
        } else if node.z > top - depth {
            NodeMaterial::Deformable(above)
        } else {
            NodeMaterial::Deformable(below)
        }
    })
}

/// A ball of radius 2 that reaches `depth` into a half space, `aside` of the middle [mm].
pub fn ball(count: u32, depth: f64, aside: f64) -> LatticeTool {
    // tissue reaches half a spacing beyond its nodes
    let up = 0.5 + 2.0 - depth;
    LatticeTool::ball(middle(count) + DVec3::new(aside, 0.0, up), 2.0)
}

/// Gives of every so many nodes, along each axis: its force, that axis, and the force by how the energy
/// falls [N].
pub fn falls_of_energy(
    lattice: &mut Lattice,
    every: usize,
    mut given: impl FnMut(DVec3, DVec3, f64),
) {
    lattice.evaluate();
    let nodes: Vec<usize> = lattice.matter_nodes().collect();
    for &index in nodes.iter().step_by(every) {
        let (force, moved) = (lattice.force(index), lattice.moved(index));
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let step = 1e-5;
            lattice.set_moved(index, moved + axis * step);
            let above = lattice.energy();
            lattice.set_moved(index, moved - axis * step);
            let below = lattice.energy();
            lattice.set_moved(index, moved);
            given(force, axis, -(above - below) / (2.0 * step));
        }
    }
}

/// Presses such tissue, so many layers of it over tissue `ratio` times as stiff, and expects that the
/// stiffness told is within a tenth that of the next step.
pub fn expect_stiffness_told(soft: Solid, layers: i32, ratio: f64) {
    let below = Solid {
        young: ratio * soft.young,
        ..soft
    };
    let mut lattice = half_space(15, true, soft, layers, below);
    let mut relaxer = Relaxer::default();
    let tool = |deep: f64| ball(15, deep, 0.0);
    let (force, _) = press(&mut relaxer, &mut lattice, tool(0.8), 1e-6, 2000);
    let told = relaxer.stiffness(&mut lattice, &[tool(0.8)], 0, 40, &|| false);
    // it left all as it was
    assert_eq!(relaxer.felt()[0].force, force);
    let (more, _) = press(&mut relaxer, &mut lattice, tool(0.85), 1e-6, 2000);
    let seen = (more.z - force.z) / 0.05;
    let far = (told / seen - 1.0).abs();
    assert!(
        far < 0.1,
        "{layers} over {ratio}: told {told}, seen {seen} N/mm"
    );
}

/// Relaxes under one tool and returns its force [N].
pub fn press(
    relaxer: &mut Relaxer,
    lattice: &mut Lattice,
    tool: LatticeTool,
    tolerance: f64,
    iterations: u32,
) -> (DVec3, RelaxReport) {
    let settings = RelaxSettings {
        tolerance,
        iterations,
        reference: 0.0,
    };
    let report = relaxer.relax(lattice, &[tool], &settings, &|| false);
    (relaxer.felt()[0].force, report)
}
