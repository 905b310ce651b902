//! Sheets of several materials.

use crate::{parse, simulation};
use isosheet_dynamics::Material;

fn paper(lines: &str) -> String {
    format!(
        "version = 1\n[sheet]\nmaterial = \"office paper\"\n\
         mesh = {{ rectangle = {{ width = 0.2, height = 0.05, columns = 32, rows = 8 }} }}\n{lines}\n"
    )
}

/// The outer half of the strip.
const OUTER: &str = "at = { box = { min = [0.0999, -1, -1], max = [1, 1, 1] } }";

fn refused(text: &str) -> String {
    match parse(text).map_err(|e| e.to_string()) {
        Err(error) => error,
        Ok(scene) => match scene.build() {
            Err(error) => error.to_string(),
            Ok(_) => panic!("accepted:\n{text}"),
        },
    }
}

/// Half of paper and half of card, or of a number of one's own.
#[test]
fn the_mass_is_that_of_all_patches() {
    let mass_of = |patch: &str| {
        let setup = parse(&paper(&format!("[[sheet.patch]]\n{patch}")));
        setup.unwrap().build().unwrap().model.mass().total()
    };
    let mass = |patch: &str| mass_of(&format!("{OUTER}\n{patch}"));
    let half = 0.5 * 0.2 * 0.05;
    let [paper, card] = [Material::office_paper(), Material::card()].map(|m| m.density);
    let found = mass("material = \"card\"");
    assert!(
        (found / (half * (paper + card)) - 1.0).abs() < 1e-12,
        "{found}"
    );
    let found = mass("material = \"card\"\ndensity = 3");
    assert!(
        (found / (half * (paper + 3.0)) - 1.0).abs() < 1e-12,
        "{found}"
    );
    // Of 512 faces of one area, these three, one of them named twice.
    let found = mass_of("at = { faces = [511, 7, 0, 7] }\nmaterial = \"card\"");
    let expected = 2.0 * half / 512.0 * (509.0 * paper + 3.0 * card);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found}");
    // The last of two patches counts where they overlap.
    let found = mass(&format!(
        "material = \"card\"\n[[sheet.patch]]\n{OUTER}\nmaterial = \"cotton\""
    ));
    let expected = half * (paper + Material::cotton().density);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found}");
}

/// A cantilever whose halves have the weights `q_1`, `q_2` and rigidities `D_1`, `D_2`: with the moment
/// `M(x)` of the weight beyond, its tip sinks by the integral of `M (L - x) / D`.
#[test]
fn a_strip_of_two_materials_hangs_as_a_beam_of_two_pieces() {
    let gravity = 0.01;
    let plate =
        |name: &str| format!("{{ youngs = {name}, thickness = 1e-4, density = 800, poisson = 0 }}");
    let [inner, outer] = [3e9, 1.2e9];
    let text = format!(
        "version = 1\n[sheet]\nmaterial = {}\ndamping = 8\n\
         mesh = {{ rectangle = {{ width = 0.2, height = 0.05, columns = 32, rows = 8 }} }}\n\
         [[sheet.patch]]\n{OUTER}\nmaterial = {}\ndensity = 0.2\n\
         [forces]\ngravity = [0, 0, -{gravity}]\n[[support]]\n\
         at = {{ box = {{ min = [-1, -1, -1], max = [1e-6, 1, 1] }} }}\nhold = \"clamp\"",
        plate("3e9"),
        plate("1.2e9")
    );
    let mut simulation = simulation(&text);
    let start = simulation.state().x.clone();
    for _ in 0..300 {
        simulation.step(1.0 / 60.0).unwrap();
    }
    let tip = simulation.state().x.as_chunks::<3>().0.iter();
    let tip = tip.zip(start.as_chunks::<3>().0);
    let tip: Vec<f64> = tip
        .filter(|(_, s)| s[0] > 0.2 - 1e-6)
        .map(|(p, _)| -p[2])
        .collect();
    let found = tip.iter().sum::<f64>() / tip.len() as f64;
    let (length, count) = (0.2, 4000);
    let h = length / f64::from(count);
    let [rigid, soft] = [inner, outer].map(|youngs: f64| youngs * 1e-12 / 12.0);
    let weight = |x: f64| gravity * if x < 0.1 { 0.08 } else { 0.2 };
    let places: Vec<f64> = (0..count).map(|k| (f64::from(k) + 0.5) * h).collect();
    let (mut force, mut moment, mut expected) = (0.0, 0.0, 0.0);
    for x in places.into_iter().rev() {
        moment += h * (force + 0.5 * h * weight(x));
        force += h * weight(x);
        expected += h * moment * (length - x) / if x < 0.1 { rigid } else { soft };
    }
    assert!((found / expected - 1.0).abs() < 1e-2, "{found} {expected}");
}

#[test]
fn patches_that_make_no_sense_are_refused() {
    let patch = |lines: &str| format!("[[sheet.patch]]\n{lines}");
    let card = format!("{OUTER}\nmaterial = \"card\"");
    for (lines, reason) in [
        (format!("mass = 0.1\n{}", patch(&card)), "give `density`"),
        (
            patch("at = { faces = [0, 512] }\nmaterial = \"card\""),
            "no face 512: the sheet has 512",
        ),
        (
            patch("at = { faces = [] }\nmaterial = \"card\""),
            "the list of faces is empty",
        ),
        ("thickness = [1e-4, 2e-4]".to_owned(), "[[sheet.patch]]"),
        (format!("bending = \"none\"\n{}", patch(&card)), "no plate"),
        (
            patch("at = { vertices = [0] }\nmaterial = \"card\""),
            "no face of the sheet has all its corners here",
        ),
        (
            patch(&format!(
                "{OUTER}\nmaterial = \"silk\"\ndirection = [1, 0, 0]"
            )),
            "does not depend on a direction",
        ),
        (
            format!(
                "yield = {{}}\n{}",
                patch(&format!("{OUTER}\nmaterial = \"silk\""))
            ),
            "nothing says when the material of the patch does",
        ),
        (
            patch(&format!("{OUTER}\nmaterial = \"crad\"")),
            "no material that is known",
        ),
        (patch(&format!("{card}\ndensity = 0")), "density"),
    ] {
        let message = refused(&paper(&lines));
        assert!(message.contains(reason), "{lines}: {message}");
    }
}

/// A patch of the material of the sheet changes nothing; a directed one lies along the direction of the
/// sheet.
#[test]
fn patches_may_yield_and_have_directions() {
    let start = |lines: &str| {
        let setup = parse(&paper(lines)).unwrap().build().unwrap();
        setup.start().unwrap()
    };
    let lines = "yield = {}\ndirection = [0, 1, 0]\n[forces]\ngravity = [0, 0, -9.81]\n[[support]]\n\
                 at = { box = { min = [-1, -1, -1], max = [1e-6, 1, 1] } }\nhold = \"clamp\"";
    let patch = format!("\n[[sheet.patch]]\n{OUTER}\nmaterial = \"office paper\"\n");
    let [mut plain, mut patched] = [lines.to_owned(), lines.to_owned() + &patch].map(|l| start(&l));
    for _ in 0..10 {
        plain.step(1.0 / 60.0).unwrap();
        patched.step(1.0 / 60.0).unwrap();
    }
    let pairs = plain.state().x.iter().zip(&patched.state().x);
    let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-9, "{off}");
}
