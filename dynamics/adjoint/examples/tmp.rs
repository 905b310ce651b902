#[path = "../tests/it/problems.rs"]
mod problems;
use cpu_time::ProcessTime;
use isosheet_adjoint::*;
use problems::*;
fn main() -> Result<(), SceneError> {
    let b = ProcessTime::now();
    for k in 0..600 {
        let s = by_heights(&[1e-4 * k as f64 / 600.0; 30])?;
        std::hint::black_box(isosheet_dynamics::Simulation::of_equations(
            s.model,
            s.start,
            at_rest().method,
        )?);
    }
    eprintln!("build {:?}", b.elapsed() / 600);
    Ok(())
}
