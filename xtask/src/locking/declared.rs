//! Which requirements may be missed, and why: what docs/locking.md shows as missed, and what depends on the
//! machine.

use super::targets::Target;
use crate::report::Effort;

/// Rods lock, and a yardstick shows by how much.
const LOCKS: &str = "rods lock where a bend follows no line of the mesh";
const COARSE: &str = "elastic paper locks on coarse meshes, less strongly than rods";
const FOLDS: &str = "the mesh decides how many folds there are";
const FINE_FOLDS: &str = "without bending stiffness folds become finer with every refinement; rods and fine meshes need more iterations";
/// What softened faces of the elastic sheet do not reach.
const UNEVEN: &str = "on some meshes the errors of the coarsest one are small by chance, which lowers the fitted order";
const STRAINED: &str = "steps with stiff faces or near the limit of strain take more iterations than weaker membranes, for which the target was set";
const CROSSED: &str =
    "strips that bend much about the diagonals of squares with both diagonals stretch";
const SOFT_TIP: &str = "softened faces near the tip of a cone stretch instead of bending";
const CAUGHT: &str = "on the union jack mesh the stiff sheet is caught in another state, with a fold that is several times as high";
const WALL: &str = "runs are stopped after a wall time, so that the number depends on the machine";
const QUICK: &str = "the meshes and times of the quick form are too small for it";

/// What is missed: yardstick, start of the quantity, models, reason.
const OPEN: [(&str, &str, &[&str], &str); 27] = [
    (
        "clamped",
        "mean factorisations a step, BDF2, refusing",
        &["rods"],
        LOCKS,
    ),
    ("clamped", "part of the sheets", &[], WALL),
    ("everyday", "part of the scenes", &[], WALL),
    ("cylinder", "", &["rods"], LOCKS),
    ("cylinder", "order", &["real stiffness"], COARSE),
    ("cylinder", "order", &["elastic"], UNEVEN),
    ("cylinder", "relative error", &["real stiffness"], COARSE),
    ("cantilever", "relative error", &["rods"], LOCKS),
    (
        "iterations",
        "factorisations a step at M^4, no",
        &["rods", "real stiffness", "elastic"],
        FINE_FOLDS,
    ),
    (
        "iterations",
        "factorisations a step at M^4, D",
        &["rods"],
        FINE_FOLDS,
    ),
    (
        "iterations",
        "factorisations a step at M^4, D",
        &[],
        STRAINED,
    ),
    (
        "iterations",
        "factorisations a step at M^5, no",
        &[],
        FINE_FOLDS,
    ),
    (
        "iterations",
        "factorisations a step at M^5, D",
        &["rods"],
        FINE_FOLDS,
    ),
    (
        "iterations",
        "factorisations a step at M^5, D",
        &[],
        STRAINED,
    ),
    ("drape", "part of the seeds", &[], FOLDS),
    ("buckling", "relative error", &["rods"], LOCKS),
    ("strips", "relative error", &["rods"], LOCKS),
    ("strips", "relative error", &["real stiffness"], COARSE),
    (
        "strips",
        "relative error of the energy",
        &["elastic"],
        CROSSED,
    ),
    ("d-cone", "difference of the", &["elastic"], SOFT_TIP),
    ("d-cone", "difference of the", &["real stiffness"], CAUGHT),
    ("d-cone", "", &["rods"], LOCKS),
    ("e-cone", "relative error", &["rods"], LOCKS),
    ("e-cone", "relative error", &["real stiffness"], COARSE),
    ("creases", "mean error", &["rods"], LOCKS),
    ("creases", "mean error", &["real stiffness"], WALL),
    ("fear", "part of the scenes", &["rods"], LOCKS),
];

/// What the quick form does not show: accuracies that need finer meshes and longer runs.
const NOT_QUICK: [(&str, &str); 10] = [
    ("iterations", "factorisations"),
    ("cylinder", "order"),
    ("cylinder", "relative error"),
    ("cantilever", "relative error"),
    ("buckling", "relative error"),
    ("clamped", "mean factorisations a step"),
    ("strips", "relative error"),
    ("d-cone", ""),
    ("e-cone", ""),
    ("creases", ""),
];

/// Why a requirement of a yardstick may be missed, if it may.
pub(super) fn declared(yardstick: &str, target: &Target, effort: Effort) -> Option<&'static str> {
    let is_open = |(of, quantity, models, _): &&(&str, &str, &[&str], &str)| {
        let is_of = models.is_empty() || models.contains(&target.of.as_str());
        *of == yardstick && target.quantity.starts_with(quantity) && is_of
    };
    let is_not_quick =
        |(of, quantity): &&(&str, &str)| *of == yardstick && target.quantity.starts_with(quantity);
    let open = OPEN.iter().find(is_open).map(|open| open.3);
    let not_quick = NOT_QUICK.iter().find(is_not_quick).map(|_| QUICK);
    open.or_else(|| not_quick.filter(|_| effort == Effort::Quick))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Bound;

    #[test]
    fn what_the_documentation_claims_is_not_declared() {
        let of =
            |model: &str, quantity: &str| Target::worst(model, quantity, Bound::AtMost(1.0), &[]);
        let why =
            |yardstick, model, quantity, effort| declared(yardstick, &of(model, quantity), effort);
        let standard = Effort::Standard;
        assert_eq!(
            why(
                "cylinder",
                "elastic",
                "relative error of the energy at M^3, every mesh and direction",
                standard
            ),
            None
        );
        assert_eq!(
            why(
                "cylinder",
                "rods",
                "order of the error of the energy",
                standard
            ),
            Some(LOCKS)
        );
        for effort in [Effort::Quick, standard] {
            assert_eq!(
                why(
                    "sliding",
                    "rods",
                    "relative error of the critical tangent",
                    effort
                ),
                None
            );
            assert_eq!(
                why("everyday", "rods", "largest strain of an edge", effort),
                None
            );
            assert_eq!(why("drape", "rods", "smallest gap, m", effort), None);
        }
        assert_eq!(
            why("cylinder", "elastic", "relative error", Effort::Quick),
            Some(QUICK)
        );
    }
}
