//! The methods without a chart, with their default options, and their names.

use isosheet_dynamics::{ImplicitOptions, Method};

/// A method with its name.
pub type Named = (&'static str, Method);

/// The damped methods, the default first.
pub fn damped() -> [Named; 2] {
    [
        ("BDF2", Method::Bdf2(Default::default())),
        ("implicit Euler", Method::ImplicitEuler(Default::default())),
    ]
}

/// BDF2 and implicit Euler, with a tolerance of their steps.
pub fn damped_to(tolerance: f64) -> [Method; 2] {
    let options = ImplicitOptions {
        tolerance: Some(tolerance),
        ..ImplicitOptions::default()
    };
    [
        Method::Bdf2(options.clone()),
        Method::ImplicitEuler(options),
    ]
}

/// The conservative methods.
pub fn conservative() -> [Named; 3] {
    [
        ("energy-momentum", energy_momentum()),
        ("RATTLE", Method::Rattle(Default::default())),
        ("RATTLE composition", rattle_composition()),
    ]
}

/// All of them.
pub fn methods() -> impl Iterator<Item = Named> {
    damped().into_iter().chain(conservative())
}

/// The energy-momentum method.
pub fn energy_momentum() -> Method {
    Method::EnergyMomentum(Default::default())
}

/// The fourth-order composition of RATTLE.
pub fn rattle_composition() -> Method {
    Method::RattleComposition(Default::default())
}

/// Implicit Euler.
pub fn implicit_euler() -> Method {
    Method::ImplicitEuler(Default::default())
}
