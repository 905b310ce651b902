//! Materials by name and by their numbers, and what is written beside them.

use crate::parse;
use isosheet_dynamics::{self as dynamics, Potential};
use isosheet_scenes::{Bending, Elasticity, IsometryKey, MaterialKey, Plate, Scene, SceneFile};
use std::path::Path;

/// A sheet of 0.02 m2 with some lines.
fn sheet(lines: &str) -> Scene {
    parse(&with(lines)).unwrap().scene().clone()
}

fn with(lines: &str) -> String {
    format!(
        "version = 1\n[sheet]\nmesh = {{ rectangle = {{ width = 0.2, height = 0.1, columns = 2, rows = 1 }} }}\n{lines}\n"
    )
}

fn refused(text: &str) -> String {
    match parse(text) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

#[test]
fn a_material_gives_mass_stiffness_and_an_elastic_sheet() {
    let paper = dynamics::Material::office_paper();
    let scene = sheet("material = \"office paper\"").sheet.remove(0);
    assert_eq!(scene.areal_density(), paper.density);
    assert_eq!(
        scene.bending(),
        Bending::Plate {
            rigidity: paper.rigidity,
            poisson: None
        }
    );
    assert_eq!(scene.plate(), Some((&paper).into()));
    assert_eq!(scene.isometry(), IsometryKey::ELASTIC);
    let numbers = Elasticity {
        law: paper.membrane(None),
        limit: paper.strain_limit,
    };
    assert_eq!(scene.elasticity(), Some(numbers));
    // Steel of half a millimetre, by its numbers.
    let steel = "material = { youngs = 2.1e11, thickness = 5e-4, density = 7850, poisson = 0.3 }";
    let steel = sheet(steel).sheet.remove(0);
    let named = sheet("material = \"Steel-Sheet\"").sheet.remove(0);
    assert_eq!(steel.areal_density(), named.areal_density());
    assert_eq!(steel.bending(), named.bending());
    assert_eq!(steel.elasticity(), named.elasticity());
}

/// Poisson's ratio of a plate: its own, that of the elasticity in the plane, of the material, or 0.3; of rods
/// as well.
#[test]
fn a_plate_has_the_poissons_ratio_of_its_sheet() {
    let steel = "material = { youngs = 2.1e11, thickness = 5e-4, density = 7850, poisson = 0.25 }";
    let plate = "bending = { plate = { rigidity = 2.0 } }";
    let rods = "isometry = \"rods\"";
    let elastic = "isometry = { elastic = { poisson = 0.1 } }";
    let own = "bending = { plate = { rigidity = 2.0, poisson = 0.5 } }";
    for (lines, poisson) in [
        ([steel, ""], 0.25),
        ([steel, rods], 0.25),
        ([steel, elastic], 0.1),
        ([steel, plate], 0.25),
        ([plate, ""], 0.3),
        ([own, steel], 0.5),
    ] {
        let lines = lines.join("\n");
        let found = sheet(&lines).sheet.remove(0).plate().expect("a plate");
        let dynamics::PlateLaw::Isotropic(found) = found else {
            panic!("{found:?}");
        };
        assert_eq!(found.poisson, poisson, "{lines}");
    }
    let wrong = "bending = { plate = { rigidity = 2.0, poisson = 0.6 } }";
    let wrong = refused(&with(wrong));
    assert!(wrong.contains("sheet.bending.plate.poisson"), "{wrong}");
}

#[test]
fn without_a_material_a_sheet_is_one_of_rods() {
    let scene = sheet("").sheet.remove(0);
    assert_eq!(scene.isometry(), IsometryKey::Rods);
    assert_eq!(scene.bending(), Bending::None);
    assert_eq!(scene.areal_density(), 0.08);
    assert_eq!(scene.elasticity(), None);
}

#[test]
fn what_is_written_beside_a_material_takes_the_place_of_what_it_gives() {
    let scene = sheet("material = \"denim\"\ndensity = 0.3\nbending = \"none\"")
        .sheet
        .remove(0);
    assert_eq!(scene.areal_density(), 0.3);
    assert_eq!(scene.bending(), Bending::None);
    let denim = dynamics::Material::denim();
    let elastic = sheet("material = \"denim\"\nisometry = { elastic = { limit = 0.03 } }")
        .sheet
        .remove(0);
    let numbers = Elasticity {
        law: denim.membrane(None),
        limit: 0.03,
    };
    assert_eq!(elastic.elasticity(), Some(numbers));
    let rods = sheet("material = \"denim\"\nisometry = \"rods\"");
    assert_eq!(rods.sheet[0].elasticity(), None);
    let setup = rods.build(Path::new("")).unwrap();
    assert!((setup.model.mass().total() - 0.02 * denim.density).abs() < 1e-15);
    assert!(setup.model.elastic_sheet().is_none());
    // A plate of the rigidity of denim, which is bent about the middle line.
    let mut x = setup.start.x.clone();
    x[2] = 0.01;
    let bent = setup.model.potential_energy(0.0, &x);
    let poisson = denim.poisson;
    let stiff = sheet(&format!(
        "isometry = \"rods\"\nbending = {{ plate = {{ rigidity = 1e-4, poisson = {poisson} }} }}"
    ));
    let stiff = stiff.build(Path::new("")).unwrap();
    let ratio = bent / stiff.model.potential_energy(0.0, &x);
    assert!((ratio - denim.rigidity / 1e-4).abs() < 1e-9, "{ratio}");
    assert!(setup.material.unwrap().starts_with("denim, washed"));
}

#[test]
fn a_scene_says_what_the_material_gives() {
    let setup = |lines: &str| sheet(lines).build(Path::new("")).unwrap();
    let paper = setup("material = \"office paper\"");
    let said = paper.material.clone().unwrap();
    for part in [
        "office paper, uncoated",
        "0.08 kg/m2",
        "3e5 N/m",
        "strain at most 5 %",
    ] {
        assert!(said.contains(part), "{said}");
    }
    let modelled = paper.modelled.join(", ");
    assert!(
        modelled.contains("elasticity in the plane (3e5 N/m; strain below 5 %)"),
        "{modelled}"
    );
    let limp = setup("material = \"office paper\"\nbending = \"none\"");
    let modelled = limp.modelled.join(", ");
    assert!(
        modelled.contains("elasticity in the plane (3e5 N/m; strain below 5 %)"),
        "{modelled}"
    );
    assert!(!modelled.contains("bending"), "{modelled}");
}

#[test]
fn an_elastic_sheet_needs_no_material() {
    let scene = sheet("isometry = { elastic = { stiffness = 1e4 } }")
        .sheet
        .remove(0);
    let numbers = Elasticity {
        law: dynamics::MembraneLaw::Isotropic {
            stiffness: 1e4,
            poisson: 0.3,
        },
        limit: 0.05,
    };
    assert_eq!(scene.elasticity(), Some(numbers));
    let text = refused(&with("isometry = { elastic = {} }"));
    assert!(
        text.contains("neither a stiffness nor a material") && text.contains("N/m"),
        "{text}"
    );
}

#[test]
fn a_sheet_yields_where_it_says_so() {
    let yields = |lines: &str| sheet(lines).sheet[0].yields();
    assert_eq!(yields("material = \"steel sheet\""), None);
    let steel = dynamics::Material::steel_sheet().yields;
    assert!(steel.is_some());
    assert_eq!(yields("material = \"steel sheet\"\nyield = {}"), steel);
    let plate = "{ youngs = 2.1e11, thickness = 5e-4, density = 7850, yield_stress = 2.35e8 }";
    assert_eq!(yields(&format!("material = {plate}\nyield = {{}}")), steel);
    let own = dynamics::Yield::perfect(2.0).in_layers(dynamics::Yield::LAYERS);
    assert_eq!(
        yields("material = \"steel sheet\"\nyield = { moment = 2 }"),
        Some(own)
    );
    let bending = "bending = { hinges = { rigidity = 1e-3 } }";
    let lines = format!("{bending}\nyield = {{ moment = 2, hardening = 1e-4 }}");
    assert_eq!(
        yields(&lines),
        Some(dynamics::Yield {
            hardening: 1e-4,
            ..own
        })
    );
    // Rubber has no moment at which it yields, and a limp sheet no moment at all.
    let text = refused(&with("material = \"rubber sheet\"\nyield = {}"));
    assert!(
        text.contains("neither a moment at which it yields"),
        "{text}"
    );
    let text = refused(&with("material = \"steel sheet\"\nyield = { layers = 0 }"));
    assert!(text.contains("sheet.yield.layers"), "{text}");
    let text = refused(&with("yield = { moment = 2 }"));
    assert!(text.contains("nothing resists bending"), "{text}");
}

#[test]
fn plates_hinges_and_creases_of_a_scene_remember() {
    let remembered = |lines: &str, rest: &str| {
        let file = parse(&format!("{}{rest}", with(lines))).unwrap();
        let setup = file.build().unwrap();
        let yielding = setup.model.potentials().filter_map(Potential::remembering);
        let yielding = yielding.filter(|p| p.can_yield());
        let counts = yielding.map(|p| p.memory().len());
        counts.sum::<usize>()
    };
    // A plate has three points in each face.
    let (faces, points, edges) = (4, 3, 3);
    let layers = dynamics::Yield::LAYERS;
    let paper = "material = \"office paper\"";
    assert_eq!(remembered(paper, ""), 0);
    assert_eq!(
        remembered(&format!("{paper}\nyield = {{}}"), ""),
        3 * layers * points * faces
    );
    let hinges = "bending = { hinges = { rigidity = 1e-3 } }\nyield = { moment = 0.1 }";
    assert_eq!(remembered(hinges, ""), layers * edges);
    let layers = format!("{paper}\nyield = {{ layers = 4 }}");
    assert_eq!(remembered(&layers, ""), 4 * 3 * points * faces);
    let crease = "[[crease]]\nat = { line = { from = [0.1, 0, 0], to = [0.1, 0.1, 0] } }\nstiffness = 0.1\n\
                  yield = { moment = 0.01 }";
    assert_eq!(remembered("", crease), 1);
}

#[test]
fn methods_without_a_place_for_it_are_refused_at_their_key() {
    let lines = "bending = { hinges = { rigidity = 1e-3 } }\nyield = { moment = 0.1 }";
    let text = format!("{}[method]\nintegrator = \"rattle\"\n", with(lines));
    let setup = parse(&text).unwrap().build().unwrap();
    let error = setup.start().err().expect("refused").to_string();
    assert!(
        error.contains("the sheet yields") && error.contains("method"),
        "{error}"
    );
}

#[test]
fn a_scene_with_a_material_is_written_as_it_is_read() {
    let plate = Plate {
        youngs: 3e9,
        thickness: 2e-4,
        density: 900.0,
        poisson: 0.35,
        youngs_across: Some(1e9),
        shear: Some(8e8),
        yield_stress: Some(2e7),
    };
    for material in [MaterialKey::named("card"), MaterialKey::Plate(plate)] {
        for isometry in [None, Some(IsometryKey::ELASTIC), Some(IsometryKey::Rods)] {
            let mut scene = sheet("");
            scene.sheet[0].material = Some(material.clone());
            scene.sheet[0].direction = Some([0.6, 0.8, 0.0].into());
            scene.sheet[0].isometry = isometry;
            let written = SceneFile::of(scene.clone(), Path::new("")).unwrap();
            assert_eq!(parse(&written.text().text).unwrap().scene(), &scene);
        }
    }
}

#[test]
fn wrong_materials_are_told_with_what_to_write() {
    let wrong = [
        (
            "material = \"ofice paper\"",
            [
                "`ofice paper` is no material",
                "did you mean `office paper`?",
            ],
        ),
        (
            "material = \"adamantium\"",
            ["no material that is known", "known here: "],
        ),
        ("material = 3", ["the name of a material in quotes", "^"]),
        (
            "material = { youngs = 1e9, thicknes = 1e-4, density = 1000 }",
            ["unknown key `thicknes`", "did you mean `thickness`?"],
        ),
        (
            "material = { youngs = 1e9, density = 1000 }",
            ["the key `thickness` is missing", "add it"],
        ),
        (
            "material = { youngs = 0, thickness = 1e-4, density = 1000 }",
            ["`sheet.material.youngs` is 0 Pa", "above 0"],
        ),
        (
            "material = { youngs = 1e9, thickness = 1e-4, density = -1 }",
            ["-1 kg/m3", "above 0"],
        ),
        (
            "material = { youngs = 1e9, thickness = 1e-4, density = 1000, poisson = 0.7 }",
            ["poisson` is 0.7", "from 0 to 0.5"],
        ),
        (
            "material = { youngs = 1.0, thickness = 1e-12, density = 1000 }",
            ["give no sheet", "in metres"],
        ),
        (
            "material = \"card\"\nisometry = { elastic = { limit = 0.5 } }",
            ["limit` is 0.5", "from 1e-6 to 0.49"],
        ),
        (
            "material = \"card\"\nisometry = { elastic = { stiffness = nan } }",
            ["NaN N/m", "above 0"],
        ),
        (
            "material = \"card\"\n[method]\nintegrator = \"rattle\"",
            [
                "needs rigid rods",
                "`isometry = \"rods\"` beside `sheet.material`",
            ],
        ),
    ];
    for (lines, parts) in wrong {
        let text = refused(&with(lines));
        for part in parts {
            assert!(text.contains(part), "{lines}: {text}");
        }
    }
    // A start beyond the limit is told at the start.
    let text = with("material = \"card\"\nstart = { perturbation = 0.05 }");
    let started = parse(&text).unwrap().build().unwrap().start();
    let text = started.err().expect("refused").to_string();
    assert!(
        text.contains("the limit of the elastic sheet is 0.05")
            && text.contains("smaller `sheet.start.perturbation`"),
        "{text}"
    );
    // All names are listed, so that one can be chosen.
    let text = refused(&with("material = \"adamantium\""));
    for name in dynamics::Material::names() {
        assert!(text.contains(name), "{name}: {text}");
    }
}

/// A material with two directions has them where the sheet names one, in its plane and in its bends: numbers
/// in words, of a name, of moduli, and of tests in the plane alone.
#[test]
fn a_sheet_has_the_directions_of_its_material_where_it_names_one() {
    let paper = dynamics::Material::office_paper();
    let x = dynamics::MaterialDirection::Uniform([0.0, 2.0, 0.0]);
    let along = "direction = [0, 2, 0]";
    let named = sheet(&format!("material = \"office paper\"\n{along}"))
        .sheet
        .remove(0);
    assert_eq!(named.plate(), Some(paper.plate(Some(&x))));
    let elasticity = named.elasticity().unwrap();
    assert_eq!(elasticity.law, paper.membrane(Some(&x)));
    let dynamics::MembraneLaw::Orthotropic(law) = elasticity.law else {
        panic!("a direction");
    };
    assert!((law.along / law.across - 2.5).abs() < 0.01 && law.along > 4.9e5);
    // Yielding at the same curvature of the mean rigidity.
    let yields = |lines: &str| sheet(lines).sheet[0].yields().unwrap();
    let isotropic = yields("material = \"office paper\"\nyield = {}");
    let directed = yields(&format!(
        "material = \"office paper\"\nyield = {{}}\n{along}"
    ));
    let mean = 3.16e-4 / paper.rigidity;
    assert!((directed.moment / isotropic.moment - mean).abs() < 1e-12);
    // Cloth that may shear.
    let cloth = sheet(&format!("material = \"cotton\"\n{along}"))
        .sheet
        .remove(0);
    assert_eq!(cloth.elasticity().unwrap().limit, 0.2);
    // By moduli: the plate of the same stuff.
    let moduli = "material = { youngs = 8e9, youngs_across = 2e9, shear = 1e9, poisson = 0.4, thickness = 1e-3, \
                  density = 700 }";
    let wood = sheet(&format!("{moduli}\n{along}")).sheet.remove(0);
    let Some(dynamics::PlateLaw::Orthotropic(plate)) = wood.plate() else {
        panic!("a direction");
    };
    let free = 1.0 - 0.4 * 0.1;
    assert!((plate.along / (8.0 / 12.0 / free) - 1.0).abs() < 1e-12);
    assert!((plate.twist / (1.0 / 12.0) - 1.0).abs() < 1e-12);
    // By tests in the plane, and of the plate; the direction is that of the sheet.
    let tests = "isometry = { elastic = { stiffness = 4e5, across = 2e5, shear = 1e5 } }\n\
                 bending = { orthotropic = { along = 4e-4, across = 2e-4, twist = 1e-4 } }";
    let tested = sheet(&format!("{tests}\n{along}")).sheet.remove(0);
    let Some(dynamics::PlateLaw::Orthotropic(plate)) = tested.plate() else {
        panic!("a direction");
    };
    assert_eq!(plate.direction, x);
    let Some(Elasticity {
        law: dynamics::MembraneLaw::Orthotropic(law),
        ..
    }) = tested.elasticity()
    else {
        panic!("a direction");
    };
    assert_eq!(
        [law.along, law.across, law.shear, law.poisson],
        [4e5, 2e5, 1e5, 0.3]
    );
    assert_eq!(law.direction, x);
}

#[test]
fn directions_that_are_missing_or_mean_nothing_are_refused() {
    let x = "direction = [1, 0, 0]";
    let plate = "bending = { orthotropic = { along = 4e-4, across = 2e-4, twist = 1e-4 } }";
    let moduli = |more: &str| {
        format!("material = {{ youngs = 8e9, {more}, thickness = 1e-3, density = 700 }}")
    };
    let elastic = |more: &str| format!("isometry = {{ elastic = {{ {more} }} }}");
    for (lines, reason) in [
        (x.to_owned(), "nothing of the sheet depends on a direction"),
        (
            format!("material = \"PET film\"\n{x}"),
            "nothing of the sheet depends",
        ),
        (plate.to_owned(), "the sheet has none"),
        (
            moduli("youngs_across = 1e9, shear = 1e9"),
            "the sheet has none",
        ),
        (format!("{}\n{x}", moduli("shear = 1e9")), "belong together"),
        (elastic("stiffness = 1, across = 1, shear = 1"), "has none"),
        (
            format!("{}\n{x}", elastic("stiffness = 1, across = 1")),
            "belong together",
        ),
        (
            format!("{}\n{x}", elastic("across = 1, shear = 1")),
            "give `stiffness`",
        ),
        (
            format!(
                "{}\n{x}",
                moduli("youngs_across = 1e9, shear = 1e9, poisson = 2.9")
            ),
            "poisson",
        ),
        (
            format!(
                "{}\n{x}",
                elastic("stiffness = 4, across = 1, shear = 1, poisson = 2.1")
            ),
            "poisson",
        ),
        (
            "material = \"cotton\"\ndirection = [0, 0, 0]".to_owned(),
            "no direction",
        ),
    ] {
        let message = refused(&with(&lines));
        assert!(message.contains(reason), "{lines}: {message}");
    }
}
