//! Writes the page of an analytic motion: a square sheet that is rolled around a lying cylinder, without stretch.
//!
//! `cargo run -p isosheet-io --features view --example page` writes `out/page.html`; another path may be given.

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::path::PathBuf;

use isosheet_io::view::{Body, BodyShape, Field, Place, Pose, Replay, Scale, Series};
use isosheet_io::write_atomically;
use isosheet_mesh::{Sheet, VertexId, fold_angle, generate};
use std::io::Write;

/// Side of the sheet, metres.
const SIDE: f64 = 0.4;
/// Radius of the cylinder, metres.
const RADIUS: f64 = 0.08;
/// Duration of the motion, seconds.
const DURATION: f64 = 2.0;
const FRAMES: usize = 121;
/// Height of the axis of the cylinder above the floor, metres.
const HEIGHT: f64 = 0.25;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("out/page.html"), PathBuf::from);
    let replay = replay(&generate::isotropic_square(3, SIDE)?)?;
    let page = replay.to_html()?;
    write_atomically(&path, |file| file.write_all(page.as_bytes()))?;
    println!("{} ({} kB)", path.display(), page.len() / 1000);
    Ok(())
}

/// Positions when the curvature is `share / RADIUS`: the sheet touches the cylinder along its middle line. With
/// the distance u from this line, a point is at `R (sin(u / R), cos(u / R) - 1)` across the line.
fn rolled(sheet: &Sheet, share: f64) -> Vec<f64> {
    let curvature = share / RADIUS;
    let middle = SIDE / 2.0;
    let mut x = sheet.positions().to_vec();
    for p in x.chunks_exact_mut(3) {
        let (u, v) = (p[0] - middle, p[1] - middle);
        let angle = curvature * u;
        // The sine quotient and its sibling are 1 and u / 2 where the curvature is zero.
        let (across, down) = if angle.abs() < 1e-6 {
            (u, -u * angle / 2.0)
        } else {
            (u * angle.sin() / angle, u * (angle.cos() - 1.0) / angle)
        };
        p.copy_from_slice(&[across, v, HEIGHT + RADIUS + down]);
    }
    x
}

fn replay(sheet: &Sheet) -> Result<Replay, Box<dyn Error>> {
    let topology = sheet.topology();
    let time = |k: usize| DURATION * k as f64 / (FRAMES - 1) as f64;
    // From flat to rolled half around and back, smoothly.
    let share = |t: f64| (1.0 - (2.0 * PI * t / DURATION).cos()) / 2.0;
    let times: Vec<f64> = (0..FRAMES).map(time).collect();
    let positions: Vec<_> = times.iter().map(|&t| rolled(sheet, share(t))).collect();
    let flat = rolled(sheet, 0.0);
    let gap = |x: &Vec<f64>| -> Vec<f64> {
        x.chunks_exact(3)
            .map(|p| p[0].hypot(p[2] - HEIGHT) - RADIUS)
            .map(|g| g.max(0.0))
            .collect()
    };
    let gaps: Vec<_> = positions.iter().map(gap).collect();
    let sharpest = |x: &Vec<f64>| -> f64 {
        let angles = topology
            .edge_ids()
            .filter_map(|e| fold_angle(topology, x, e));
        angles.map(f64::abs).fold(0.0, f64::max).to_degrees()
    };
    let series = |name: &str, unit: &str, scale, values| Series {
        name: name.into(),
        unit: unit.into(),
        scale,
        times: times.clone(),
        values,
    };
    let strain = Field::edge_strain(&sheet.face_indices(), &flat, &positions)?;
    let largest = |rows: &[Vec<f64>]| {
        rows.iter()
            .map(|r| r.iter().copied().fold(0.0, f64::max))
            .collect()
    };
    let lying = Pose {
        rotation: [FRAC_PI_4.sin(), 0.0, 0.0, FRAC_PI_4.cos()],
        translation: [0.0, 0.0, HEIGHT],
    };
    // The ball rolls along the floor without slipping: it turns by distance over radius.
    let ball = |&t: &f64| {
        let way = 0.3 * share(t);
        let half = way / 0.05 / 2.0;
        Pose {
            rotation: [0.0, half.sin(), 0.0, half.cos()],
            translation: [way - 0.15, -0.3, 0.05],
        }
    };
    let body = |name: &str, shape, poses| Body {
        name: name.into(),
        shape,
        poses,
    };
    let middle = (0..topology.vertex_count()).filter(|&v| flat[3 * v].abs() < 1e-9);
    Ok(Replay {
        title: "A sheet rolled around a cylinder".into(),
        faces: sheet.face_indices(),
        rest: flat.clone(),
        pins: middle.map(|v| VertexId::from_index(v).0).collect(),
        bodies: vec![
            body("floor", BodyShape::HalfSpace, vec![Pose::IDENTITY]),
            body(
                "cylinder",
                BodyShape::Cylinder {
                    radius: 0.99 * RADIUS,
                    half_height: 0.6 * SIDE,
                },
                vec![lying],
            ),
            body(
                "ball",
                BodyShape::Sphere { radius: 0.05 },
                times.iter().map(ball).collect(),
            ),
        ],
        series: vec![
            series(
                "curvature",
                "1/m",
                Scale::Linear,
                times.iter().map(|&t| share(t) / RADIUS).collect(),
            ),
            series(
                "sharpest fold",
                "°",
                Scale::Linear,
                positions.iter().map(sharpest).collect(),
            ),
            series(
                "largest strain",
                "",
                Scale::Logarithmic,
                largest(&strain.values),
            ),
            series("largest gap", "m", Scale::Linear, largest(&gaps)),
        ],
        fields: vec![
            strain,
            Field {
                name: "gap to the cylinder".into(),
                unit: "m".into(),
                place: Place::Vertex,
                scale: Scale::Linear,
                values: gaps,
            },
        ],
        summary: vec![
            (
                "motion".into(),
                "analytic, without stretch of the smooth sheet".into(),
            ),
            ("side".into(), format!("{SIDE} m")),
            (
                "radius".into(),
                format!(
                    "{RADIUS} m, touched over {:.0}°",
                    (SIDE / RADIUS / FRAC_PI_2 * 90.0)
                ),
            ),
            ("mesh".into(), "M^3".into()),
        ],
        scene: format!(
            "side = {SIDE}\nradius = {RADIUS}\nduration = {DURATION}\nframes = {FRAMES}\n"
        ),
        reproduce: "cargo run -p isosheet-io --features view --example page".into(),
        times,
        positions,
        ..Replay::default()
    })
}
