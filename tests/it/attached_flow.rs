//! Attached flow: flags that flutter.

use isosheet_tests::flag::{Flag, Resolution, slender, slender_threshold};

#[test]
fn explore() {
    for beta in [0.01, 0.1, 0.2, 0.3, 0.5, 0.7] {
        let height = 0.2;
        let air = std::f64::consts::PI * height / 4.0;
        let flag = Flag {
            height,
            mass: air * (1.0 - beta) / beta,
            wind: 0.0,
        };
        let c = slender_threshold(flag);
        println!(
            "beta {beta}: U {c} u {} {:?}",
            c * air.sqrt(),
            slender(Flag { wind: c, ..flag })
        );
    }
    let number = |name: &str, or: f64| std::env::var(name).map_or(or, |t| t.parse().unwrap());
    let height = number("H", 0.2);
    let beta = number("BETA", 0.2);
    let cells = [number("NX", 10.0) as usize, number("NY", 2.0) as usize];
    let per = number("PER", 50.0);
    let air = std::f64::consts::PI * height / 4.0;
    let flag = Flag {
        height,
        mass: air * (1.0 - beta) / beta,
        wind: 0.0,
    };
    let threshold = slender_threshold(flag);
    {
        for factor in [0.8, 0.9, 1.0, 1.1, 1.2] {
            let flag = Flag {
                wind: factor * threshold,
                ..flag
            };
            let period = std::f64::consts::TAU / slender(flag).frequency;
            let step = period / per;
            let mut run = flag.simulation(Resolution { cells, step });
            let mut largest = Vec::new();
            let clock = std::time::Instant::now();
            let mut effort = (0, 0, 0);
            for _ in 0..8 {
                let mut m: f64 = 0.0;
                for _ in 0..per as usize {
                    match run.step(step) {
                        Ok(r) => {
                            effort.0 += r.substeps;
                            effort.1 += r.iterations;
                            effort.2 += r.factorisations;
                        }
                        Err(e) => {
                            println!("{e}");
                            return;
                        }
                    }
                    m = m.max(Flag::deflection(&run).abs());
                }
                largest.push(m);
            }
            let rates: Vec<f64> = largest
                .windows(2)
                .map(|w| (w[1] / w[0]).ln() / period)
                .collect();
            println!(
                "{cells:?} {per} {factor}: {:?} {rates:.3?} theory {:?} effort {effort:?} {:?}",
                largest.last(),
                slender(flag),
                clock.elapsed()
            );
        }
    }
}
