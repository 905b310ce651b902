//! A strip that yields.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::{Line, material};
use anyhow::Result;
use isosheet_dynamics::{Interpolation, Profile, SheetModel, Yield};

/// Moment of a section that has yielded in the whole of its thickness, over the rigidity and the length.
const MOMENT: f64 = 1e-3;

/// Hardening of the section in one layer, over the rigidity.
const HARDENING: f64 = 1.0 / 3.0;

/// Largest moments over [`MOMENT`]: of the section in one layer, and of those in several.
const LOADS: [f64; 2] = [1.3, 0.95];

pub(super) const YIELDING: Experiment = Experiment {
    name: "plastic-cantilever",
    title: "Cantilever that stays bent",
    source: "Elastic-plastic section (Gardiner 1957; Prager and Hodge 1951), integrated along the strip",
    about: "A strip four times as long as wide, Poisson's ratio 0, clamped at one end, under a force at the other that \
            comes and goes: where its end stays. Of one layer with hardening D / 3, up to 1.3 of the moment M_y at \
            which it yields; of the usual number of layers without hardening, up to 0.95 of that of the whole section, \
            against the section of infinitely many.",
    quantities: || {
        let one = |m: f64| (m - 1.0).max(0.0) * MOMENT / HARDENING;
        let section = |m: f64| {
            let first = 2.0 / 3.0;
            let k = if m > first {
                first / (3.0 * (1.0 - m)).sqrt()
            } else {
                m
            };
            (k - m) * MOMENT
        };
        let several = residual(LOADS[1], section);
        vec![
            Quantity::new("residual tip, 1 layer", residual(LOADS[0], one)),
            Quantity::new("residual tip, in layers", several),
        ]
    },
    measure: yielding,
};

/// The tip of a strip of length 1 whose curvature follows from the moment over [`MOMENT`], which is linear
/// and so large at the clamp.
fn residual(largest: f64, curvature: impl Fn(f64) -> f64) -> f64 {
    let panels = 20_000;
    let h = 1.0 / f64::from(panels);
    let at = |i: i32| {
        let arm = (f64::from(i) + 0.5) * h;
        arm * curvature(largest * arm) * h
    };
    (0..panels).map(at).sum()
}

fn yielding(job: Job) -> Result<Measured> {
    let width = 0.25;
    let strip = job.cantilever([1.0, width])?;
    let material = material(1.0, 0.0, 0.01 * width);
    let tip = Line::at(&strip.sheet, 0, 1.0);
    let mut all = Measured::default();
    for (layers, largest, hardening) in [(1, LOADS[0], HARDENING), (Yield::LAYERS, LOADS[1], 0.0)] {
        let yields = Yield {
            moment: MOMENT,
            hardening,
            layers,
        };
        let force = largest * MOMENT * width;
        let course = Profile::Keyframes {
            interpolation: Interpolation::Linear,
            // At its largest until the strip has followed.
            keys: vec![[0.0, 0.0], [10.0, force], [16.0, force], [26.0, 0.0]],
        };
        let model = SheetModel::of_material(&strip.sheet, &material);
        let model = model.clamped(&strip.clamp).yielding(yields).build()?;
        let mut rest = Rest::new(&strip.sheet, 0.1 * MOMENT, 1.0);
        rest.under(model.with_force(tip.load_of(course, [0.0, 0.0, 1.0])?))?;
        all.add(Measured::at_rest(&rest, vec![tip.mean(&rest.x, 2)]));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without yield beyond `1 / m` of the length the tip of the section in one layer is an integral of a
    /// polynomial.
    #[test]
    fn the_residual_of_one_layer_is_a_polynomial() {
        let m = 1.3_f64;
        let exact = m / 3.0 * (1.0 - m.powi(-3)) - 0.5 * (1.0 - m.powi(-2));
        let found = residual(m, |m| (m - 1.0).max(0.0));
        assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
    }
}
