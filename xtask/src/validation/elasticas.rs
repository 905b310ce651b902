//! Heavy, loaded and buckled elasticas.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::{Line, clamped_along, material, with_plate};
use crate::runs::meshes::{vertices, with_line};
use anyhow::Result;
use isosheet_dynamics::{Material, PointProfile, Profile, SheetModel};
use isosheet_tests::{Elastica, buckled};

/// Weights over `D / L^3`, and the place of the end over the length: along, down.
const WEIGHTS: [(f64, [f64; 2]); 5] = [
    (1.0, [0.99125, 0.12347]),
    (3.0, [0.93151, 0.33965]),
    (10.0, [0.65635, 0.70020]),
    (100.0, [0.15922, 0.93752]),
    (1000.0, [0.04599, 0.98114]),
];

/// The weight over `D / L^3` in Peirce's test: the bending length is half of what hangs over.
const PEIRCE: f64 = 8.0;

/// Strips under their weight.
pub(super) const HEAVY: Experiment = Experiment {
    name: "heavy-elastica",
    title: "Strip that hangs from a clamp",
    source: "Love 1927, section 262, and Rohde 1953, integrated; Peirce 1930 and ASTM D1388 for 41.5 degrees",
    about: "A strip four times as long as wide, Poisson's ratio 0, clamped horizontally at one end, under weights of \
            Gamma = q L^3 / D: where its end is. With Gamma = 8 the line from the clamp to the end has the slope of \
            the bending length test.",
    quantities: || {
        let places = WEIGHTS.iter().flat_map(|(gamma, [x, drop])| {
            [
                Quantity::of_scale(format!("x/L, Gamma = {gamma}"), *x, 1.0),
                Quantity::new(format!("drop/L, Gamma = {gamma}"), *drop),
            ]
        });
        let slope = Quantity::new("slope for Gamma = 8, degrees", 41.5);
        places.chain([slope]).collect()
    },
    measure: heavy,
};

fn heavy(job: Job) -> Result<Measured> {
    let strip = job.cantilever([1.0, 0.25])?;
    let material = material(1.0, 0.0, 1e-3);
    let tip = Line::at(&strip.sheet, 0, 1.0);
    let mut rest = Rest::new(&strip.sheet, 1.0, 1.0);
    let mut hang = |gamma: f64| -> Result<[f64; 2]> {
        let model = SheetModel::of_material(&strip.sheet, &material);
        let model = model.clamped(&strip.clamp).build()?;
        rest.under(model.with_acceleration([0.0, 0.0, -gamma]))?;
        Ok([tip.mean(&rest.x, 0), -tip.mean(&rest.x, 2)])
    };
    let mut values = Vec::new();
    for (gamma, _) in WEIGHTS {
        values.extend(hang(gamma)?);
    }
    let [x, drop] = hang(PEIRCE)?;
    values.push(drop.atan2(x).to_degrees());
    Ok(Measured::at_rest(&rest, values))
}

/// Bartels.
pub(super) const LIFTED: Experiment = Experiment {
    name: "bartels-lifted",
    title: "Strip that a load lifts",
    source: "Bartels 2013, example 6.1",
    about: "A strip of 4 x 1 with rigidity D, Poisson's ratio 0, clamped at one end, under 0.025 D up per area: the \
            energy and the place of the end.",
    quantities: || {
        vec![
            Quantity::new("energy / D", -1.5775e-2),
            Quantity::new("x of the end", 3.9130),
            Quantity::new("z of the end", 0.7758),
        ]
    },
    measure: lifted,
};

fn lifted(job: Job) -> Result<Measured> {
    let length = 4.0;
    let strip = job.cantilever([length, 1.0])?;
    let material = material(1.0, 0.0, 1e-3);
    let model = || -> Result<SheetModel> {
        let model = SheetModel::of_material(&strip.sheet, &material);
        let model = model.clamped(&strip.clamp).build()?;
        Ok(model.with_acceleration([0.0, 0.0, 0.025]))
    };
    let mut rest = Rest::new(&strip.sheet, 1.0, length * length);
    rest.under(model()?)?;
    let energy = model()?.potential_energy(0.0, &rest.x);
    let tip = Line::at(&strip.sheet, 0, length);
    let [x, z] = [0, 2].map(|k| tip.mean(&rest.x, k));
    Ok(Measured::at_rest(&rest, vec![energy, x, z]))
}

/// Shortenings, parts of the length; the last is that of Bartels.
const SHORTENINGS: [f64; 5] = [0.05, 0.1, 0.2, 0.3, 0.7];

/// Strips between clamps.
pub(super) const PUSHED: Experiment = Experiment {
    name: "pushed-together",
    title: "Strip that is pushed together",
    source: "Elastica by elliptic integrals (Love 1927, section 263); Bartels 2013, example 6.3",
    about: "A strip of 4 x 1 with rigidity D, Poisson's ratio 0, whose ends are clamped flat and pushed together: how \
            high its middle is over its length. At 70 % (1.2 apart) the energy, too. A hundredth of the weight of \
            rigidity D / L^3 chooses the side.",
    quantities: || {
        let high = |part: &f64| {
            let name = format!("height/L, {:.0} % shorter", 100.0 * part);
            Quantity::new(name, buckled(1.0 - part)[1])
        };
        let energy = Quantity::new("energy / D, 70 % shorter", 8.582);
        SHORTENINGS.iter().map(high).chain([energy]).collect()
    },
    measure: pushed,
};

/// Steps over which a clamp moves.
const MOVING: f64 = 20.0;

fn pushed(job: Job) -> Result<Measured> {
    let length = 4.0;
    let mut strip = job.between_clamps([length, 1.0])?;
    let cell = 1.0 / job.across as f64;
    strip.sheet = with_line(&strip.sheet, 0.5 * length, cell)?;
    strip.clamp = vertices(&strip.sheet, |[x, ..]| x < 1e-9 || x > length - 1e-9);
    let material = material(1.0, 0.0, 1e-3);
    let middle = Line::at(&strip.sheet, 0, 0.5 * length);
    let mut rest = Rest::new(&strip.sheet, 1.0, length * length);
    let model = || {
        SheetModel::of_material(&strip.sheet, &material)
            .clamped(&strip.clamp)
            .build()
    };
    let (mut values, mut before) = (Vec::new(), 0.0);
    for part in SHORTENINGS {
        let mut moved = model()?.with_acceleration([0.0, 0.0, 0.01 / length.powi(3)]);
        for &v in strip
            .clamp
            .iter()
            .filter(|v| strip.sheet.position(**v)[0] > 0.5 * length)
        {
            let push = PointProfile {
                offset: strip.sheet.position(v),
                x: Profile::SmoothStep {
                    from: -before * length,
                    to: -part * length,
                    begin: 0.0,
                    end: MOVING * rest.step,
                },
                ..PointProfile::default()
            };
            moved = moved.with_moving_pin(v, push)?;
        }
        rest.under(moved)?;
        // Upwards or downwards: from flat, either may come first.
        values.push(middle.mean(&rest.x, 2).abs() / length);
        before = part;
    }
    values.push(model()?.potential_energy(0.0, &rest.x));
    Ok(Measured::at_rest(&rest, values))
}

/// Free length of the sheet of paper, and its width, metres.
const PAPER: [f64; 2] = [0.287, 0.21];

/// How far the sheet is in its clamp, metres.
const IN_CLAMP: f64 = 0.01;

const GRAVITY: f64 = 9.81;

/// Paper.
pub(super) const OFFICE: Experiment = Experiment {
    name: "office-paper",
    title: "A4 sheet of office paper in a clamp",
    source: "Elastica integrated (Rohde 1953), 80 g/m2, 5e-4 N m",
    about: "Office paper clamped horizontally with 10 mm of its short edge in the clamp: how far the free end hangs \
            down. Once all corners of faces in the clamp are pinned, once a single line of vertices at the edge of the \
            clamp has its slope held.",
    quantities: || {
        let Material {
            rigidity, density, ..
        } = Material::office_paper();
        let elastica = Elastica {
            length: PAPER[0],
            rigidity,
            weight: density * GRAVITY,
        };
        let drop = elastica.drop();
        let names = ["drop, m", "drop with one line of vertices, m"];
        names.map(|name| Quantity::new(name, drop)).to_vec()
    },
    measure: office,
};

fn office(job: Job) -> Result<Measured> {
    let [length, width] = PAPER;
    let material = Material::office_paper();
    let step = length * length * (material.density / material.rigidity).sqrt();
    let down = [0.0, 0.0, -GRAVITY];
    let cell = width / job.across as f64;
    let sheet = job
        .mesh
        .rectangle([-IN_CLAMP, 0.0], [length, width], cell)?;
    // Vertices nearer than a quarter of the clamp are moved onto its edge.
    let sheet = with_line(&sheet, 0.0, IN_CLAMP)?;
    let clamp = vertices(&sheet, |[x, ..]| x < 1e-9);
    let mut rest = Rest::new(&sheet, length, step);
    let model = SheetModel::of_material(&sheet, &material).clamped(&clamp);
    rest.under(model.build()?.with_acceleration(down))?;
    let drop = -Line::at(&sheet, 0, length).mean(&rest.x, 2);
    let mut measured = Measured::at_rest(&rest, vec![drop]);

    let sheet = job.rectangle(PAPER)?;
    let clamp = vertices(&sheet, |[x, ..]| x < 1e-9);
    let mut rest = Rest::new(&sheet, length, step);
    let plate = clamped_along(&sheet, &material, &clamp)?;
    rest.under(with_plate(&sheet, &material, &clamp, plate)?.with_acceleration(down))?;
    let drop = -Line::at(&sheet, 0, length).mean(&rest.x, 2);
    measured.add(Measured::at_rest(&rest, vec![drop]));
    Ok(measured)
}
