//! Scenes as functions of numbers.

use crate::error::SceneError;
use isosheet_dynamics::contact::Contact;
use isosheet_dynamics::{Method, StepControl};
use isosheet_model::{SheetModel, State};

/// A scene: a model, where it starts, and what it touches.
pub struct Scene {
    /// The model.
    pub model: SheetModel,
    /// The state at its start.
    pub start: State,
    /// Bodies and contact of the sheet with itself.
    pub contact: Option<Box<dyn Contact>>,
}

impl Scene {
    /// Without contact.
    pub fn new(model: SheetModel, start: State) -> Self {
        Self {
            model,
            start,
            contact: None,
        }
    }

    /// With contact.
    #[must_use]
    pub fn with_contact(self, contact: impl Contact + 'static) -> Self {
        Self {
            contact: Some(Box::new(contact)),
            ..self
        }
    }
}

/// A scene as a function of some numbers, the parameters of a gradient: stiffnesses, angles, coefficients,
/// positions of the mesh, numbers of the functions of time that move supports. For all numbers it has the
/// same topology and the same pinned vertices.
///
/// A closure is one.
pub trait Family: Sync {
    /// The scene with these numbers, the same each time.
    ///
    /// # Errors
    /// Why there is none.
    fn scene(&self, numbers: &[f64]) -> Result<Scene, SceneError>;
}

impl<F: Fn(&[f64]) -> Result<Scene, SceneError> + Sync> Family for F {
    fn scene(&self, numbers: &[f64]) -> Result<Scene, SceneError> {
        self(numbers)
    }
}

/// How a scene is run.
#[derive(Debug, Clone)]
pub struct Plan {
    /// BDF2, implicit Euler, or a search for equilibria.
    pub method: Method,
    /// The control of its steps.
    pub control: StepControl,
    /// The lengths of the steps, seconds.
    pub steps: Vec<f64>,
}

impl Plan {
    /// So many steps of `h` seconds.
    pub fn steps(method: Method, h: f64, count: usize) -> Self {
        Self {
            method,
            control: StepControl::default(),
            steps: vec![h; count],
        }
    }
}
