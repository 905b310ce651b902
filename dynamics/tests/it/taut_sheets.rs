//! Elastic sheets that are taut or loaded, against closed forms.

use isosheet_dynamics::{
    ImplicitOptions, Material, Method, PointMotion, Profile, SheetModel, Simulation, State,
    VertexLoad,
};
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{Sheet, VertexId};

const STIFFNESS: f64 = 3e5;

fn mesh(kind: Option<Diagonals>, cells: [usize; 2], size: [f64; 2]) -> Sheet {
    let [length, width] = size;
    let corners = [[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]];
    match kind {
        Some(diagonals) => generate::grid(cells[0], cells[1], length, width, diagonals).unwrap(),
        None => generate::delaunay(&corners, width / cells[1] as f64, 5).unwrap(),
    }
}

const KINDS: [Option<Diagonals>; 3] = [Some(Diagonals::UnionJack), Some(Diagonals::Falling), None];

/// Moves until it is at rest.
fn settled(model: SheetModel, sheet: &Sheet, steps: usize) -> Simulation {
    let start = State::at_rest(sheet.positions().to_vec());
    let method = Method::ImplicitEuler(Default::default());
    let model = model.with_damping(4.0).unwrap();
    let mut run = Simulation::new(model, start, method).unwrap();
    for _ in 0..steps {
        run.step(0.05).unwrap();
    }
    run
}

/// `F L / (E h w)`, of a strip that is clamped at one end and pulled by 1 N at the other. (At the clamp the
/// strip cannot narrow.)
#[test]
fn a_strip_that_is_pulled_obeys_hooke() {
    let (length, width) = (0.3, 0.06);
    for kind in KINDS {
        let sheet = mesh(kind, [20, 4], [length, width]);
        let clamp = sheet.vertices_where(|[x, ..]| x < 1e-9);
        let end = sheet.vertices_where(|[x, ..]| x > length - 1e-9);
        let mut heights: Vec<f64> = end.iter().map(|v| sheet.position(*v)[1]).collect();
        heights.sort_by(f64::total_cmp);
        let paper = Material::office_paper();
        let builder = SheetModel::of_material(&sheet, &paper).clamped(&clamp);
        let mut model = builder.build().unwrap();
        for v in &end {
            let y = sheet.position(*v)[1];
            let k = heights.iter().position(|other| *other == y).unwrap();
            let middle = |j: usize| heights.get(j).map_or(y, |other| 0.5 * (other + y));
            let below = k.checked_sub(1).map_or(y, middle);
            let part = Profile::Constant((middle(k + 1) - below) / width);
            let load = VertexLoad::new(sheet.topology(), &[*v], [1.0, 0.0, 0.0], part).unwrap();
            model = model.with_force(load);
        }
        let run = settled(model, &sheet, 40);
        let moved = end.iter().map(|v| run.state().x[3 * v.index()] - length);
        let mean = moved.sum::<f64>() / end.len() as f64;
        let hooke = length / (STIFFNESS * width);
        assert!(
            (mean / hooke - 1.0).abs() < 0.02,
            "{kind:?}: {mean} {hooke}"
        );
    }
}

/// A sheet between two lines of pins sags under its weight `q` as far as it stretches: to a parabola of depth
/// `s`, `s^3 = 3 q L^4 / (64 E h)`.
#[test]
fn a_taut_sheet_sags_as_far_as_it_stretches() {
    let length = 0.2;
    for kind in KINDS {
        let sheet = mesh(kind, [20, 2], [length, 0.02]);
        let ends = sheet.vertices_where(|[x, ..]| !(1e-9..length - 1e-9).contains(&x));
        let paper = Material::office_paper();
        let builder = SheetModel::of_material(&sheet, &paper).clamped(&ends);
        let run = settled(builder.build().unwrap().with_gravity(), &sheet, 60);
        let lowest = run.state().x.iter().skip(2).step_by(3).copied();
        let sag = -lowest.fold(0.0, f64::min);
        let exact = (3.0 * paper.density * 9.8 * length.powi(4) / (64.0 * STIFFNESS)).cbrt();
        assert!((sag / exact - 1.0).abs() < 0.02, "{kind:?}: {sag} {exact}");
    }
}

/// A ribbon that is twisted by the angle `t` per length, its ends at their distance, pulls with
/// `E h t^2 w^3 / 24`, as its sides are helices.
#[test]
fn a_twisted_ribbon_pulls_as_its_sides_are_stretched() {
    let (length, width, angle) = (0.3, 0.01, std::f64::consts::PI);
    for kind in [Some(Diagonals::UnionJack), None] {
        let sheet = mesh(kind, [120, 4], [length, width]);
        let paper = Material::office_paper();
        let mut model = SheetModel::of_material(&sheet, &paper).build().unwrap();
        let start = sheet.vertices_where(|[x, ..]| x < 1e-9);
        model = model.with_pins(&start).unwrap();
        for v in sheet.vertices_where(|[x, ..]| x > length - 1e-9) {
            let y = sheet.position(v)[1] - 0.5 * width;
            let turn = move |t: f64| -> [f64; 3] {
                let (sin, cos) = (angle * (0.5 * t).min(1.0)).sin_cos();
                [length, 0.5 * width + y * cos, y * sin]
            };
            model = model.with_moving_pin(v, PointMotion::from(turn)).unwrap();
        }
        let run = settled(model, &sheet, 80);
        let held = run.reactions().into_iter();
        let held = held.filter(|r| start.contains(&r.support.vertex()));
        let pull = -held.map(|r| r.force[0]).sum::<f64>();
        let exact = STIFFNESS * (angle / length).powi(2) * width.powi(3) / 24.0;
        assert!(
            (pull / exact - 1.0).abs() < 0.05,
            "{kind:?}: {pull} {exact}"
        );
    }
}

/// A film that is held at its corners under a weight comes to rest, and its supports carry what it weighs.
/// (With slack that follows the bends freely it flipped between two states, and the supports carried a
/// fifth.)
#[test]
fn a_loaded_film_comes_to_rest() {
    let sheet = generate::isotropic_square(2, 0.2).unwrap();
    let material = Material::office_paper();
    let corner = |v: &VertexId| {
        let p = sheet.position(*v);
        p[..2]
            .iter()
            .all(|c| c.abs() < 1e-9 || (c - 0.2).abs() < 1e-9)
    };
    let corners: Vec<VertexId> = sheet.topology().vertex_ids().filter(corner).collect();
    let middle: Vec<VertexId> = sheet
        .topology()
        .vertex_ids()
        .filter(|v| {
            sheet.position(*v)[..2]
                .iter()
                .all(|c| (0.06..0.14).contains(c))
        })
        .collect();
    let load = || {
        let each = Profile::Constant(0.06 / middle.len() as f64);
        VertexLoad::new(sheet.topology(), &middle, [0.0, 0.0, -1.0], each).unwrap()
    };
    let model = || {
        let model = SheetModel::of_material(&sheet, &material).build().unwrap();
        let model = model
            .with_pins(&corners)
            .unwrap()
            .with_damping(5.0)
            .unwrap();
        model
            .with_acceleration([0.0, 0.0, -9.81])
            .with_force(load())
    };
    let weight = 0.06 + 9.81 * model().mass().total();
    for method in [
        Method::ImplicitEuler(ImplicitOptions::default()),
        Method::default(),
    ] {
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run = Simulation::new(model(), start, method).unwrap();
        for _ in 0..300 {
            run.step(1.0 / 60.0).unwrap();
        }
        let speed = run.state().v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!(speed < 1e-4, "{speed}");
        let held: f64 = run.reactions().iter().map(|r| r.force.z).sum();
        assert!((held / weight - 1.0).abs() < 1e-3, "{held} {weight}");
    }
}
