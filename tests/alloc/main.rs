//! Allocations of a step after warm-up, counted by a global allocator.

use isosheet_dynamics::{ElasticSheet, Method, PlateBending, SheetModel, Simulation, State, Yield};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::f64::consts::PI;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// A bumped square that hangs by a corner.
fn hanging(method: Method) -> Simulation {
    let flat = generate::isotropic_square(2, 1.0).expect("valid");
    let mut x = flat.positions().to_vec();
    for p in x.chunks_mut(3) {
        p[2] = 0.05 * (PI * p[0]).sin() * (PI * p[1]).sin();
    }
    let sheet = Sheet::new(x, &flat.face_indices()).expect("valid");
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .expect("valid")
        .with_gravity()
        .with_pins(&[VertexId(72)])
        .expect("the corner exists");
    Simulation::new(model, State::at_rest(sheet.positions().to_vec()), method).expect("valid")
}

/// A flat, elastic square that hangs by a corner, and bends by its weight where it yields.
fn elastic(yields: Option<Yield>) -> Simulation {
    let sheet = generate::isotropic_square(2, 1.0).expect("valid");
    let mut plate = PlateBending::new(&sheet, 5e-4).expect("valid");
    if let Some(yields) = yields {
        plate = plate.with_yield(&sheet, yields).expect("valid");
    }
    let elastic = ElasticSheet::new(&sheet, 3e5, 0.3).expect("valid");
    let elastic = elastic.beside(&sheet, &plate);
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .expect("valid")
        .with_gravity()
        .with_pins(&[VertexId(72)])
        .expect("the corner exists")
        .with_potential(plate)
        .with_elastic_sheet(elastic)
        .expect("the same sheet");
    let start = State::at_rest(sheet.positions().to_vec());
    Simulation::new(model, start, Method::default()).expect("valid")
}

/// Allocations and reallocations, and factorisations, in 20 steps after warm-up, in which what can yield
/// does.
fn count(mut run: Simulation) -> (usize, usize) {
    let can_yield = run.model().can_yield();
    let mut plastic = 0.0;
    for _ in 0..20 {
        plastic = run.step(1e-3).expect("accepted").plastic;
    }
    let before = plastic;
    let region = Region::new(ALLOCATOR);
    let mut factorisations = 0;
    for _ in 0..20 {
        let report = run.step(1e-3).expect("accepted");
        factorisations += report.factorisations;
        plastic = report.plastic;
    }
    let change = region.change();
    assert_eq!(plastic > before, can_yield, "{plastic} J after {before} J");
    (change.allocations + change.reallocations, factorisations)
}

/// Inside `faer`, a numeric LU factorisation builds its lists of compressed rows and columns anew each
/// time. This is the bound for the allocations of one factorisation of this mesh; measured were 69 and 73.
const PER_LU: usize = 80;

// One test: a second one would allocate beside it.
#[test]
fn steps_do_not_allocate() {
    for (name, run, per_factorisation) in [
        ("BDF2", hanging(Method::default()), 0),
        ("BDF2, elastic sheet", elastic(None), 0),
        (
            "BDF2, elastic sheet that yields",
            elastic(Some(Yield::perfect(1e-6))),
            0,
        ),
        (
            "implicit Euler",
            hanging(Method::ImplicitEuler(Default::default())),
            0,
        ),
        (
            "energy-momentum",
            hanging(Method::EnergyMomentum(Default::default())),
            PER_LU,
        ),
        (
            "RATTLE",
            hanging(Method::Rattle(Default::default())),
            PER_LU,
        ),
    ] {
        let (allocations, factorisations) = count(run);
        println!("{name}: {allocations} in {factorisations} factorisations");
        assert!(factorisations >= 20, "{name}: every step solves");
        assert!(
            allocations <= per_factorisation * factorisations,
            "{name}: {allocations} allocations in 20 steps with {factorisations} factorisations"
        );
    }
}
