//! Replays for the tests.

use isosheet_formats::BodyPose;
use isosheet_mesh::{Sheet, generate};
use isosheet_page::{Axis, Body, BodyShape, Centering, Field, Replay, Scale, TimeSeries};

/// Pseudo-random numbers in [0, 1): the low-discrepancy sequence of the golden ratio.
pub(crate) fn scattered(k: usize) -> f64 {
    (k as f64 * 0.618_033_988_749_894_9).fract()
}

/// Numbers of both signs over ten decades, and zeros.
fn forces(edges: usize, frame: usize) -> Vec<f64> {
    let force = |e: usize| match (e + frame) % 7 {
        0 => 0.0,
        k => (-1.0_f64).powi(k as i32) * 10.0_f64.powf(10.0 * scattered(e + 97 * frame) - 6.0),
    };
    (0..edges).map(force).collect()
}

/// A sheet with sides of 1 m that waves: smooth motion of every coordinate, with some noise of 10
/// micrometres.
pub(crate) fn waving(level: u32, frames: usize) -> Replay {
    let sheet = generate::isotropic_square(level, 1.0).unwrap();
    let times: Vec<f64> = (0..frames).map(|k| k as f64 / 60.0).collect();
    let positions: Vec<Vec<f64>> = times
        .iter()
        .enumerate()
        .map(|(k, &t)| wave(&sheet, k, t))
        .collect();
    let faces = sheet.face_indices();
    let depths = |x: &Vec<f64>| x.iter().skip(2).step_by(3).map(|z| 0.5 - z).collect();
    let fields = vec![
        Field::edge_strain(&faces, sheet.positions(), &positions).unwrap(),
        Field {
            name: "depth <b>&\u{e4}".into(),
            unit: "m".into(),
            place: Centering::Vertex,
            scale: Scale::Linear,
            note: String::new(),
            values: positions.iter().map(depths).collect(),
        },
        Field {
            name: "rod force".into(),
            unit: "N".into(),
            place: Centering::Edge,
            scale: Scale::Signed,
            note: "Forces <i>& are one choice.".into(),
            values: (0..frames)
                .map(|k| forces(sheet.topology().edge_count(), k))
                .collect(),
        },
    ];
    let series = |name: &str, unit: &str, scale, f: fn(f64) -> f64| TimeSeries {
        name: name.into(),
        unit: unit.into(),
        scale,
        times: times.clone(),
        values: times.iter().map(|&t| f(t)).collect(),
    };
    Replay {
        title: "A waving sheet </title></script> & more".into(),
        rest: sheet.positions().to_vec(),
        pins: vec![0, 1],
        series: vec![
            series("kinetic energy", "J", Scale::Linear, |t| t.sin().powi(2)),
            series("potential energy", "J", Scale::Linear, |t| t.cos().powi(2)),
            series("strain", "", Scale::Logarithmic, |t| {
                (1e-12 * (t - 0.5)).max(0.0)
            }),
            series("constant", "m", Scale::Logarithmic, |_| 1e-3),
        ],
        summary: vec![
            ("steps".into(), frames.to_string()),
            ("<i>".into(), "&lt;".into()),
        ],
        scene: "radius = 1 # </script><script>throw 1</script>\n".into(),
        reproduce: "isosheet simulate scene.toml".into(),
        faces,
        times,
        positions,
        fields,
        ..Replay::default()
    }
}

fn wave(sheet: &Sheet, frame: usize, t: f64) -> Vec<f64> {
    let mut x = sheet.positions().to_vec();
    for (v, p) in x.chunks_exact_mut(3).enumerate() {
        let phase = 6.0 * p[0] + 3.0 * p[1] - 4.0 * t;
        let noise = 1e-5 * scattered(frame * 7919 + v);
        p[2] += 0.1 * phase.sin() + noise;
        p[0] += 0.02 * phase.cos();
        p[1] -= 0.1 * t.sin();
    }
    x
}

/// A body of every shape around a small sheet; two of them move.
pub(crate) fn every_body(frames: usize) -> Replay {
    let mut replay = waving(2, frames);
    replay.up = Axis::Y;
    let half = std::f64::consts::FRAC_PI_8;
    let turned = [half.sin(), 0.0, 0.0, half.cos()];
    let body = |name: &str, shape, x: f64| Body {
        name: name.into(),
        shape,
        poses: vec![BodyPose {
            rotation: turned,
            translation: [x, -0.6, 0.2],
        }],
    };
    let tetrahedron = BodyShape::Mesh {
        vertices: vec![0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 0.4],
        faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    };
    let upward = [-2.0 * half, 0.0, 0.0].map(f64::sin);
    let cuboid = BodyShape::Cuboid {
        half: [0.1, 0.2, 0.1],
    };
    let cylinder = BodyShape::Cylinder {
        radius: 0.1,
        half_height: 0.2,
    };
    let capsule = BodyShape::Capsule {
        radius: 0.1,
        half_length: 0.1,
    };
    replay.bodies = vec![
        // The z axis of the half-space is turned to the y axis of space, which is up.
        Body {
            name: "floor".into(),
            shape: BodyShape::HalfSpace,
            poses: vec![BodyPose {
                rotation: [upward[0], 0.0, 0.0, upward[0].abs()],
                translation: [0.0, -0.9, 0.0],
            }],
        },
        body("cuboid", cuboid, -0.4),
        body("ball", BodyShape::Sphere { radius: 0.15 }, 0.0),
        body("cylinder", cylinder, 0.4),
        body("capsule", capsule, 0.8),
        body("tetrahedron", tetrahedron, 1.2),
    ];
    for body in &mut replay.bodies[1..3] {
        let pose = body.poses[0];
        let at = |k: usize| BodyPose {
            translation: [
                pose.translation[0],
                pose.translation[1] + 0.01 * k as f64,
                0.2,
            ],
            ..pose
        };
        body.poses = (0..frames).map(at).collect();
    }
    replay
}
