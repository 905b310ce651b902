//! Inverse problems: families of scenes, and losses of them.

use isosheet_adjoint::{Loss, OfState, Plan, Scene, SceneError, Share};
use isosheet_dynamics::{
    Curl, Curvature, ImplicitOptions, Material, MaterialDirection, Method, NaturalTensor,
    SheetModel, State,
};
use isosheet_mesh::{Sheet, VertexId, generate};

pub(crate) const LENGTH: f64 = 0.3;

/// Options whose steps are solved as far as numbers allow.
pub(crate) fn exact() -> ImplicitOptions {
    ImplicitOptions {
        tolerance: Some(1e-13),
        friction_tolerance: 1e-10,
        max_friction_updates: 40,
        ..ImplicitOptions::default()
    }
}

/// A scene that starts at rest, where its mesh is.
pub(crate) fn as_meshed(model: SheetModel, sheet: &Sheet) -> Scene {
    Scene::new(model, State::at_rest(sheet.positions().to_vec()))
}

pub(crate) fn at_rest() -> Plan {
    Plan::steps(Method::Equilibrium(exact()), 1.0, 1)
}

/// A strip that is clamped at its left end, with a width of a tenth of its length.
pub(crate) fn strip(cells: usize) -> Result<Sheet, SceneError> {
    // The clamp is a column of faces before the strip.
    let cell = LENGTH / cells as f64;
    let grid = generate::anisotropic_grid(cells + 1, 2, LENGTH + cell, 0.1 * LENGTH)?;
    Ok(grid.map_positions(|[x, y, z]| [x - cell, y, z])?)
}

/// Film that is soft in its plane.
fn film() -> Material {
    let mut film = Material::office_paper();
    film.stiffness = 300.0;
    film.rigidity = 1e-3;
    film
}

/// A corner of the tip of a strip of twelve cells.
pub(crate) const TIP: usize = 13;

/// Paper by its rigidity, newton metres.
pub(crate) fn by_rigidity(p: &[f64]) -> Result<Scene, SceneError> {
    let sheet = strip(12)?;
    let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
    let mut paper = Material::office_paper();
    paper.rigidity = p[0];
    let model = SheetModel::of_material(&sheet, &paper)
        .clamped(&clamp)
        .build()?
        .with_gravity();
    Ok(as_meshed(model, &sheet))
}

/// Paper by the height of its clamp, metres.
pub(crate) fn by_clamp(p: &[f64]) -> Result<Scene, SceneError> {
    let sheet = strip(12)?;
    let height = p[0];
    let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
    let lifted = sheet.map_positions(|[x, y, z]| [x, y, z + height])?;
    let model = SheetModel::of_material(&sheet, &Material::office_paper())
        .clamped(&clamp)
        .build()?
        .with_gravity();
    let start = State::at_rest(lifted.positions().to_vec());
    Ok(Scene::new(model, start))
}

/// Film by the curl of three patches, 1/m.
pub(crate) fn by_curls(p: &[f64]) -> Result<Scene, SceneError> {
    let sheet = strip(12)?;
    let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
    let t = sheet.topology();
    let patch = |face: &[VertexId; 3]| {
        let x: f64 = face.iter().map(|v| sheet.position(*v)[0]).sum::<f64>() / 3.0;
        let number = ((3.0 * x / LENGTH).max(0.0) as usize).min(2);
        Curvature {
            along: p[number],
            ..Curvature::default()
        }
    };
    let curl = Curl {
        direction: MaterialDirection::Uniform([1.0, 0.0, 0.0]),
        curvature: NaturalTensor::Faces(t.faces().iter().map(patch).collect()),
        profile: 1.0.into(),
    };
    let model = SheetModel::of_material(&sheet, &film())
        .clamped(&clamp)
        .curled(curl)
        .build()?
        .with_acceleration([0.0, 0.0, -0.5]);
    Ok(as_meshed(model, &sheet))
}

/// Film by the heights of its rest shape, metres: those of the columns of vertices from the clamp on, which
/// keep their distances.
pub(crate) fn by_heights(p: &[f64]) -> Result<Scene, SceneError> {
    let cell = LENGTH / p.len() as f64;
    let flat = strip(p.len())?;
    let mut places = vec![[-cell, 0.0], [0.0, 0.0]];
    for z in p {
        let [x, before] = places[places.len() - 1];
        let rise: f64 = z - before;
        places.push([x + (cell * cell - rise * rise).sqrt(), *z]);
    }
    let sheet = flat.map_positions(|[x, y, _]| {
        let column = ((x + cell) / cell).round() as usize;
        let [x, z] = places[column];
        [x, y, z]
    })?;
    let clamp = flat.vertices_where(|[x, _, _]| x < 1e-9);
    let model = SheetModel::of_material(&sheet, &film())
        .clamped(&clamp)
        .curved()
        .build()?
        .with_acceleration([0.0, 0.0, -0.5]);
    Ok(as_meshed(model, &sheet))
}

/// Half the sum of the squared heights of so many columns of vertices beyond the clamp, at rest, square
/// metres.
pub(crate) fn squared_heights(columns: usize) -> impl Loss {
    move |n: usize, state: &State| {
        (n == 1).then(|| {
            let mut of = OfState::zeros(state.x.len());
            let mut value = 0.0;
            for v in 2..columns + 2 {
                let z = state.x[3 * v + 2];
                value += 0.5 * z * z;
                of.x[3 * v + 2] = z;
            }
            Share::of_state(value, of)
        })
    }
}
