//! The program that the documentation begins with.

use isosheet::prelude::*;
use std::fs;
use std::path::Path;

/// The first Rust program of a text.
fn program(text: &str) -> &str {
    let after = text.split_once("```rust\n").expect("a program").1;
    after.split_once("```").expect("its end").0
}

#[test]
fn all_pages_have_the_same_program() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: &str| fs::read_to_string(package.join(path)).unwrap();
    let own = read("README.md");
    for page in ["../../README.md", "../../docs/rust.md"] {
        assert_eq!(program(&read(page)), program(&own), "{page}");
    }
}

/// The supports and the obstacle carry a sheet at rest.
#[test]
fn forces_of_a_sheet_at_rest_balance_its_weight() -> Result<(), Box<dyn std::error::Error>> {
    let sheet = generate::anisotropic_grid(12, 8, 0.3, 0.2)?;
    let clamp = sheet.vertices_where(|[x, _, _]| x < 0.03);
    assert_eq!(clamp.len(), 2 * 9);
    let paper = Material::named("office paper")?;
    let model = SheetModel::of_material(&sheet, &paper)
        .clamped(&clamp)
        .build()?;
    let model = model.with_gravity().with_damping(20.0)?;
    let ball = Obstacle::at(Shape::Sphere { radius: 0.05 }, [0.25, 0.1, -0.06])?;
    let contacts = Contacts::for_sheet(&model, [ball], Coefficients::equal(0.3))?;
    let start = State::at_rest(sheet.positions().to_vec());
    let mut simulation =
        Simulation::new(model, start, Method::default())?.with_contact(contacts)?;
    simulation.run(4.0, 1.0 / 30.0, &mut [])?;

    let supports = simulation.support_forces();
    let held: Vec<VertexId> = supports
        .iter()
        .map(|(support, _)| support.vertex())
        .collect();
    assert_eq!(held, clamp);
    let ball = simulation.obstacle_forces()[0];
    assert!(ball[2] < -1e-3, "the sheet rests on the ball: {ball:?} N");
    // What the ball does to the sheet is the opposite of that.
    let sum = |k: usize| supports.iter().map(|(_, force)| force[k]).sum::<f64>() - ball[k];
    let weight = paper.density * sheet.area() * 9.8;
    for (k, expected) in [0.0, 0.0, weight].into_iter().enumerate() {
        assert!(
            (sum(k) - expected).abs() < 1e-3 * weight,
            "axis {k}: {} N",
            sum(k)
        );
    }
    for [x, y, z] in simulation.state().vertex_positions() {
        let distance = ((x - 0.25).powi(2) + (y - 0.1).powi(2) + (z + 0.06).powi(2)).sqrt();
        assert!(distance > 0.05, "outside of the ball");
    }
    Ok(())
}
