//! The page of a run that goes on, which a server sends its states to.

use serde::Serialize;

/// What the page of a run that goes on has beside that of a recorded one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LivePage {
    /// What can be changed while the run goes on.
    pub sliders: Vec<LiveSlider>,
    /// Goes into the attribute `nonce` of the scripts, for a content security policy.
    #[serde(skip)]
    pub nonce: String,
}

/// A number that can be changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LiveSlider {
    /// Its name.
    pub name: String,
    /// Its unit, which may be empty.
    pub unit: String,
    /// The smallest value.
    pub low: f64,
    /// The largest value.
    pub high: f64,
}
