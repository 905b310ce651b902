//! Writes the page of an analytic motion: a square sheet that rolls around a lying cylinder and back.
//!
//! `cargo run -p isosheet-io --features view --example page` writes `out/page.html` or another path.

use std::error::Error;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::io::Write;
use std::path::PathBuf;

use isosheet_io::BodyPose;
use isosheet_io::view::{Body, BodyShape, Centering, Field, Replay, Scale, TimeSeries};
use isosheet_io::write_atomically;
use isosheet_mesh::{Sheet, Topology, fold_angle, generate};

/// Side of the sheet, metres.
const SIDE: f64 = 0.4;
/// Radius of the cylinder, metres.
const RADIUS: f64 = 0.08;
/// Height of the axis of the cylinder above the floor, metres.
const HEIGHT: f64 = 0.25;
/// Radius of a ball that rolls beside it, metres.
const BALL: f64 = 0.05;
/// Duration of the motion, seconds.
const DURATION: f64 = 2.0;
const FRAMES: usize = 121;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1);
    let path = path.map_or_else(|| PathBuf::from("out/page.html"), PathBuf::from);
    let page = replay(&generate::isotropic_square(3, SIDE)?)?.to_html()?;
    write_atomically(&path, |file| file.write_all(page.as_bytes()))?;
    println!("{} ({} kB)", path.display(), page.len() / 1000);
    Ok(())
}

/// The curvature of the sheet as a share of that of the cylinder: from 0 to 1 and back, smoothly.
fn share(t: f64) -> f64 {
    (1.0 - (TAU * t / DURATION).cos()) / 2.0
}

/// Positions of a sheet with the curvature k that touches the cylinder along its middle line. A point at the
/// distance u from this line is at `(sin(k u) / k, -(1 - cos(k u)) / k)` across and above the line.
fn rolled(sheet: &Sheet, share: f64) -> Vec<f64> {
    let mut x = sheet.positions().to_vec();
    for p in x.chunks_exact_mut(3) {
        let (u, v) = (p[0] - SIDE / 2.0, p[1] - SIDE / 2.0);
        let angle = share / RADIUS * u;
        // (1 - cos a) / a = sin^2(a/2) / (a/2), and (sin a) / a = 1 where the angle a is zero.
        let quotient = |a: f64| if a == 0.0 { 1.0 } else { a.sin() / a };
        let down = u * quotient(angle / 2.0) * (angle / 2.0).sin();
        p.copy_from_slice(&[u * quotient(angle), v, HEIGHT + RADIUS - down]);
    }
    x
}

fn replay(sheet: &Sheet) -> Result<Replay, Box<dyn Error>> {
    let last = (FRAMES - 1) as f64;
    let times: Vec<f64> = (0..FRAMES).map(|k| DURATION * k as f64 / last).collect();
    let positions: Vec<_> = times.iter().map(|&t| rolled(sheet, share(t))).collect();
    let rest = rolled(sheet, 0.0);
    let faces = sheet.face_indices();
    let fields = vec![
        Field::edge_strain(&faces, &rest, &positions)?,
        gaps(&positions),
    ];
    let on_middle_line = |&v: &u32| rest[3 * v as usize].abs() < 1e-9 * SIDE;
    Ok(Replay {
        title: "A sheet rolls around a cylinder".into(),
        pins: (0..rest.len() as u32 / 3).filter(on_middle_line).collect(),
        bodies: bodies(&times),
        series: series(sheet.topology(), &times, &positions, &fields),
        summary: vec![
            (
                "motion".into(),
                "analytic; isometric for a smooth sheet".into(),
            ),
            ("side".into(), format!("{SIDE} m")),
            ("radius".into(), format!("{RADIUS} m")),
            (
                "touched at most over".into(),
                format!("{:.0}°", (SIDE / RADIUS).to_degrees()),
            ),
        ],
        scene: format!(
            "side = {SIDE}\nradius = {RADIUS}\nduration = {DURATION}\nframes = {FRAMES}\n"
        ),
        reproduce: "cargo run -p isosheet-io --features view --example page".into(),
        faces,
        times,
        positions,
        rest,
        fields,
        ..Replay::default()
    })
}

/// Distances of the vertices from the cylinder. The rims of the faces lie inside it by round-off.
fn gaps(positions: &[Vec<f64>]) -> Field {
    let gap = |p: &[f64]| (p[0].hypot(p[2] - HEIGHT) - RADIUS).max(0.0);
    Field {
        name: "gap to the cylinder".into(),
        unit: "m".into(),
        place: Centering::Vertex,
        scale: Scale::Linear,
        note: String::new(),
        values: positions
            .iter()
            .map(|x| x.chunks_exact(3).map(gap).collect())
            .collect(),
    }
}

fn bodies(times: &[f64]) -> Vec<Body> {
    let body = |name: &str, shape, poses| Body {
        name: name.into(),
        shape,
        poses,
    };
    // A quarter turn about x puts the axis along y.
    let lying = BodyPose {
        rotation: [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2],
        translation: [0.0, 0.0, HEIGHT],
    };
    // The flat faces of the sheet cut into a cylinder whose radius is that of the vertices.
    let cylinder = BodyShape::Cylinder {
        radius: 0.985 * RADIUS,
        half_height: 0.6 * SIDE,
    };
    // The ball turns by the way over its radius; a quaternion has half the angle.
    let rolling = |&t: &f64| {
        let way = 0.3 * share(t);
        let half = way / BALL / 2.0;
        BodyPose {
            rotation: [0.0, half.sin(), 0.0, half.cos()],
            translation: [way - 0.15, -0.3, BALL],
        }
    };
    let ball = BodyShape::Sphere { radius: BALL };
    vec![
        body("floor", BodyShape::HalfSpace, vec![BodyPose::IDENTITY]),
        body("cylinder", cylinder, vec![lying]),
        body("ball", ball, times.iter().map(rolling).collect()),
    ]
}

fn series(
    topology: &Topology,
    times: &[f64],
    positions: &[Vec<f64>],
    fields: &[Field],
) -> Vec<TimeSeries> {
    let one = |name: &str, unit: &str, scale, values| TimeSeries {
        name: name.into(),
        unit: unit.into(),
        scale,
        times: times.to_vec(),
        values,
    };
    let largest = |values: &Vec<f64>| values.iter().copied().fold(0.0, f64::max);
    let sharpest = |x: &Vec<f64>| {
        let angles = topology
            .edge_ids()
            .filter_map(|e| fold_angle(topology, x, e));
        angles.map(f64::abs).fold(0.0, f64::max).to_degrees()
    };
    let curvatures = times.iter().map(|&t| share(t) / RADIUS).collect();
    let folds = positions.iter().map(sharpest).collect();
    let [strains, gaps] = [0, 1].map(|k: usize| fields[k].values.iter().map(largest).collect());
    vec![
        one("curvature", "1/m", Scale::Linear, curvatures),
        one("sharpest fold", "°", Scale::Linear, folds),
        one("largest strain", "", Scale::Logarithmic, strains),
        one("largest gap", "m", Scale::Linear, gaps),
    ]
}
