//! Benchmarks of shells: sheets that are curved without stress, under small loads.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::Line;
use crate::runs::meshes::{nearest, vertices, with_line};
use anyhow::Result;
use isosheet_dynamics::constraint::{Line as Straight, Plane, Side};
use isosheet_dynamics::{
    Isotropic, LineClamp, Material, PlateBending, PlateEdges, Profile, RigidDisplacement,
    SheetModel, VertexConstraint, VertexLoad,
};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use std::f64::consts::{FRAC_PI_2, PI};

/// The material of a shell; one square metre weighs 1 kg.
fn shell(youngs: f64, thickness: f64, poisson: f64) -> Result<Material> {
    Ok(Material::isotropic(Isotropic {
        youngs,
        thickness,
        density: 1.0 / thickness,
        poisson,
    })?)
}

/// The model of a shell that is free of stress as it is, and symmetric about planes through the origin along
/// lines of its outline: there vertices stay in the plane, and slopes as they are.
fn symmetric(
    sheet: &Sheet,
    material: &Material,
    lines: &[(Vec<VertexId>, [f64; 3])],
) -> Result<SheetModel> {
    let clamp = |(line, _): &(Vec<VertexId>, [f64; 3])| LineClamp {
        vertices: line.clone(),
        positions: sheet.positions().to_vec(),
        motion: RigidDisplacement::default().into(),
    };
    let clamps: Vec<LineClamp> = lines.iter().map(clamp).collect();
    let edges = PlateEdges {
        clamps: &clamps,
        ..PlateEdges::default()
    };
    let plate = PlateBending::held(sheet, material, &edges)?.curved(sheet);
    let mut model = SheetModel::new(sheet, sheet.area(), MassKind::Lumped)?
        .with_elastic_sheet(material.elastic_sheet(sheet, &plate)?)?
        .with_potential(plate);
    for (line, normal) in lines {
        for &v in line {
            let plane = Plane::new([0.0; 3], *normal)?;
            model = model.with_constraint(VertexConstraint::on_surface(v, plane, Side::On))?;
        }
    }
    Ok(model)
}

/// A model whose vertices on a line move along x alone.
fn on_diaphragm(mut model: SheetModel, sheet: &Sheet, line: &[VertexId]) -> Result<SheetModel> {
    for &v in line {
        let rail = Straight::new(sheet.position(v), [1.0, 0.0, 0.0])?;
        model = model.with_constraint(VertexConstraint::on_curve(v, rail))?;
    }
    Ok(model)
}

fn time(material: &Material, length: f64) -> f64 {
    length * length / material.rigidity.sqrt()
}

/// A quarter of a cylinder about the x axis as a flat mesh, with a line across its middle, and round.
fn quarter(job: Job, radius: f64, length: f64) -> Result<[Sheet; 2]> {
    let arc = FRAC_PI_2 * radius;
    let flat = job.rectangle([length, arc])?;
    let flat = with_line(&flat, 0.5 * length, length.min(arc) / job.across as f64)?;
    let round = flat.map_positions(|[x, y, _]| {
        let (s, c) = (y / radius).sin_cos();
        [x, radius * s, radius * c]
    })?;
    Ok([flat, round])
}

/// The deflection under one of two forces that pinch a cylinder at the middle, over the force.
fn pinched(
    job: Job,
    (radius, length): (f64, f64),
    material: &Material,
    expected: f64,
    ends: &[f64],
) -> Result<Measured> {
    let [flat, sheet] = quarter(job, radius, length)?;
    let arc = FRAC_PI_2 * radius;
    let sides = [0.0, arc].map(|y| vertices(&flat, |p| (p[1] - y).abs() < 1e-9 * arc));
    let point = nearest(&flat, [0.5 * length, 0.0]);
    let [top, side] = sides;
    let mut model = symmetric(
        &sheet,
        material,
        &[(top, [0.0, 1.0, 0.0]), (side, [0.0, 0.0, 1.0])],
    )?;
    for end in ends {
        let inner = |p: [f64; 3]| (p[0] - end).abs() < 1e-9 * length;
        let rim = vertices(&flat, |p| {
            inner(p) && p[1] > 1e-9 * arc && p[1] < arc * (1.0 - 1e-9)
        });
        model = on_diaphragm(model, &sheet, &rim)?;
    }
    let deflection = 1e-6 * radius;
    // Half of the force acts on either side of the plane of symmetry.
    let force = Profile::Constant(0.5 * deflection / expected);
    let load = VertexLoad::new(sheet.topology(), &[point], [0.0, 0.0, -1.0], force)?;
    let mut rest = Rest::new(&sheet, deflection, time(material, radius));
    rest.under(model.with_force(load))?;
    let moved = sheet.position(point)[2] - rest.x[3 * point.index() + 2];
    Ok(Measured::at_rest(
        &rest,
        vec![moved / deflection * expected],
    ))
}

/// Free ends.
pub(super) const FREE_CYLINDER: Experiment = Experiment {
    name: "pinched-free-cylinder",
    title: "Pinched cylinder with free ends",
    source: "Takemoto and Cook 1973; Cook 1981, pages 284 to 287",
    about: "A cylinder of the radius 4.953, 10.35 long and 0.094 thick, E = 10.5e6, Poisson's ratio 0.3125, is pinched \
            at the middle by two forces of 100 (linear theory; a quarter around, as long as the whole): the deflection \
            under a force.",
    quantities: || vec![Quantity::new("deflection", 0.1139)],
    measure: |job| {
        let mut measured = pinched(
            job,
            (4.953, 10.35),
            &shell(10.5e6, 0.094, 0.3125)?,
            0.1139 / 100.0,
            &[],
        )?;
        measured.values.iter_mut().for_each(|v| *v *= 100.0);
        Ok(measured)
    },
};

/// Diaphragms.
pub(super) const CYLINDER: Experiment = Experiment {
    name: "pinched-cylinder",
    title: "Pinched cylinder with end diaphragms",
    source: "Lindberg, Olson and Cowper 1969: 164.24 P / (E t)",
    about: "A cylinder twice as long as its radius and a hundred times thinner, Poisson's ratio 0.3, with rigid \
            diaphragms at its ends that let it move along its axis, is pinched at the middle by two forces (linear \
            theory; a quarter around, as long as the whole): the deflection under a force.",
    quantities: || vec![Quantity::new("deflection E t / P", 164.24)],
    measure: |job| {
        pinched(
            job,
            (100.0, 200.0),
            &shell(1.0, 1.0, 0.3)?,
            164.24,
            &[0.0, 200.0],
        )
    },
};

/// The hemisphere.
pub(super) const HEMISPHERE: Experiment = Experiment {
    name: "pinched-hemisphere",
    title: "Pinched hemisphere with a hole",
    source: "MacNeal and Harder 1985 (0.0940)",
    about: "A hemisphere of the radius 10 with a hole of 18 degrees at its pole, 0.04 thick, E = 6.825e7, Poisson's \
            ratio 0.3, is pinched and pulled at four points of its equator by forces of 2 (linear theory, a quarter): \
            the mean deflection at the points.",
    quantities: || vec![Quantity::new("deflection", 0.094)],
    measure: hemisphere,
};

fn hemisphere(job: Job) -> Result<Measured> {
    let (radius, hole) = (10.0, 18.0_f64.to_radians());
    // Latitude along x, longitude along y.
    let (high, wide) = (FRAC_PI_2 - hole, FRAC_PI_2);
    let flat = job.rectangle([high, wide])?;
    let sheet = flat.map_positions(|[latitude, longitude, _]| {
        let ((s, c), (t, d)) = (latitude.sin_cos(), longitude.sin_cos());
        [radius * c * d, radius * c * t, radius * s]
    })?;
    let material = shell(6.825e7, 0.04, 0.3)?;
    let sides = [0.0, wide].map(|y| vertices(&flat, |p| (p[1] - y).abs() < 1e-9));
    let [first, second] = sides;
    let lines = [(first, [0.0, 1.0, 0.0]), (second, [1.0, 0.0, 0.0])];
    let mut model = symmetric(&sheet, &material, &lines)?;
    let points = [[0.0, 0.0], [0.0, wide]].map(|p| nearest(&flat, p));
    let part = 1e-3;
    for (v, along) in points.iter().zip([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]) {
        let load = VertexLoad::new(sheet.topology(), &[*v], along, Profile::Constant(part))?;
        model = model.with_force(load);
    }
    let mut rest = Rest::new(&sheet, part * 0.1, time(&material, radius));
    rest.under(model)?;
    let moved = |k: usize| rest.x[3 * points[k].index() + k] - sheet.position(points[k])[k];
    let deflection = 0.5 * (moved(1) - moved(0)) / part;
    Ok(Measured::at_rest(&rest, vec![deflection]))
}

/// The roof.
pub(super) const ROOF: Experiment = Experiment {
    name: "scordelis-lo-roof",
    title: "Roof of Scordelis and Lo",
    source: "Scordelis and Lo 1964; MacNeal and Harder 1985 (0.3024)",
    about: "A part of 80 degrees of a cylinder of the radius 25, 50 long and 0.25 thick, E = 4.32e8, Poisson's ratio 0, \
            lies on diaphragms at its ends under 90 per area (linear theory): how far the middle of a free edge goes \
            down.",
    quantities: || vec![Quantity::new("deflection", 0.3024)],
    measure: roof,
};

fn roof(job: Job) -> Result<Measured> {
    let (radius, length, half) = (25.0, 50.0, 40.0_f64.to_radians());
    let arc = 2.0 * half * radius;
    let flat = job.rectangle([length, arc])?;
    let flat = with_line(&flat, 0.5 * length, arc / job.across as f64)?;
    let sheet = flat.map_positions(|[x, y, _]| {
        let (s, c) = (y / radius - half).sin_cos();
        [x, radius * s, radius * c]
    })?;
    let material = shell(4.32e8, 0.25, 0.0)?;
    let ends = vertices(&flat, |[x, ..]| x < 1e-9 || x > length - 1e-9);
    let model = on_diaphragm(symmetric(&sheet, &material, &[])?, &sheet, &ends)?;
    let part = 1e-4;
    let mut rest = Rest::new(&sheet, 0.3 * part, time(&material, radius));
    rest.under(model.with_acceleration([0.0, 0.0, -90.0 * part]))?;
    let point = nearest(&flat, [0.5 * length, 0.0]);
    let moved = sheet.position(point)[2] - rest.x[3 * point.index() + 2];
    Ok(Measured::at_rest(&rest, vec![moved / part]))
}

/// The twisted beam.
pub(super) const TWISTED: Experiment = Experiment {
    name: "twisted-beam",
    title: "Beam that is twisted without stress",
    source: "Belytschko, Wong and Stolarski 1989, after MacNeal and Harder 1985",
    about: "A strip 12 long, 1.1 wide and 0.0032 thick, twisted by a right angle along its length, E = 29e6, Poisson's \
            ratio 0.22, clamped at one end under a force of 1e-6 at the other, in and across the plane that it has \
            there (linear theory): how far the end goes in the direction of the force.",
    quantities: || {
        vec![
            Quantity::new("in the plane", 0.005_256),
            Quantity::new("across", 0.001_294),
        ]
    },
    measure: twisted,
};

fn twisted(job: Job) -> Result<Measured> {
    let [length, width] = [12.0, 1.1];
    let strip = job.cantilever([length, width])?;
    let sheet = strip.sheet.map_positions(|[x, y, _]| {
        let (s, c) = (FRAC_PI_2 * x / length).sin_cos();
        let y = y - 0.5 * width;
        [x, y * c, y * s]
    })?;
    let tip = Line::at(&sheet, 0, length);
    let material = shell(29e6, 0.0032, 0.22)?;
    let part = 1e-2;
    let mut all = Measured::default();
    // The end stands upright: its plane has the z axis.
    for k in [2, 1] {
        let mut along = [0.0; 3];
        along[k] = 1.0;
        let model = SheetModel::of_material(&sheet, &material);
        let model = model.clamped(&strip.clamp).curved().build()?;
        let load = tip.load(1e-6 * part, along)?;
        let mut rest = Rest::new(&sheet, 1e-3 * part, time(&material, length));
        rest.under(model.with_force(load))?;
        let moved = tip.moved(&sheet, &rest.x, k);
        all.add(Measured::at_rest(&rest, vec![moved / part]));
    }
    Ok(all)
}

/// The annulus.
pub(super) const ANNULUS: Experiment = Experiment {
    name: "slit-annulus",
    title: "Slit annulus under a line force",
    source: "Sze, Liu and Lo 2004, table 4",
    about: "A flat annulus between the radii 6 and 10, 0.03 thick, E = 21e6, Poisson's ratio 0, slit along a radius and \
            clamped on one side of the slit; a force of P = 0.8 per length lifts the other side: how high its inner and \
            its outer end rise. Squares are across the ring, and twelve times as many along it.",
    quantities: || {
        let of = |(part, inner, outer): &(f64, f64, f64)| {
            [
                Quantity::new(format!("inner at {part} P"), *inner),
                Quantity::new(format!("outer at {part} P"), *outer),
            ]
        };
        LIFTED.iter().flat_map(of).collect()
    },
    measure: annulus,
};

const LIFTED: [(f64, f64, f64); 4] = [
    (0.1, 4.277, 5.876),
    (0.25, 7.602, 10.288),
    (0.5, 10.468, 13.768),
    (1.0, 13.891, 17.528),
];

fn annulus(job: Job) -> Result<Measured> {
    let [inner, outer] = [6.0, 10.0];
    let middle = 0.5 * (inner + outer);
    let around = 2.0 * PI * middle;
    let strip = job.cantilever([around, outer - inner])?;
    let sheet = strip.sheet.map_positions(|[x, y, _]| {
        let (s, c) = (x / middle).sin_cos();
        [(inner + y) * c, (inner + y) * s, 0.0]
    })?;
    let material = shell(21e6, 0.03, 0.0)?;
    let edge = Line::at(&strip.sheet, 0, around);
    let ends = [0.0, outer - inner].map(|y| nearest(&strip.sheet, [around, y]));
    let mut rest = Rest::new(&sheet, outer, time(&material, around));
    let mut values = Vec::new();
    for (part, ..) in LIFTED {
        let model = SheetModel::of_material(&sheet, &material);
        let model = model.clamped(&strip.clamp).build()?;
        let load = edge.load(0.8 * part * (outer - inner), [0.0, 0.0, 1.0])?;
        rest.under(model.with_force(load))?;
        values.extend(ends.map(|v| rest.x[3 * v.index() + 2]));
    }
    Ok(Measured::at_rest(&rest, values))
}
