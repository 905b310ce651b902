use super::catalogue::plain;
use super::*;

/// Materials whose thickness is a part of their form: name, thickness (m), Young's modulus (Pa).
const PLATES: [(&str, f64, f64); 3] = [
    ("steel sheet", 5e-4, 2.1e11),
    ("aluminium foil", 1.6e-5, 6.9e10),
    ("PET film", 1e-4, 4.9e9),
];

#[test]
fn every_material_is_valid_and_found_by_its_name() {
    let names: Vec<&str> = Material::names().collect();
    assert!(names.len() >= 20);
    for (k, named) in Material::catalogue().iter().enumerate() {
        assert_eq!(named.material.validate(), Ok(()), "{}", named.name);
        assert_eq!(Material::named(named.name), Ok(named.material));
        assert!(
            named.source.contains("oisson") || named.source.contains("Typical"),
            "{}",
            named.name
        );
        let same = |name: &&str| plain(name) == plain(named.name);
        assert_eq!(names.iter().position(same), Some(k), "{}", named.name);
    }
    assert_eq!(
        Material::named("office paper"),
        Ok(Material::office_paper())
    );
}

#[test]
fn a_name_may_be_written_in_other_ways() {
    for name in ["Office Paper", "office-paper", " office_paper"] {
        assert_eq!(Material::named(name), Ok(Material::office_paper()));
    }
    assert_eq!(
        Material::named("aluminum foil"),
        Ok(Material::aluminium_foil())
    );
}

#[test]
fn an_unknown_name_is_answered_with_the_nearest_first() {
    for (wrong, right) in [
        ("ofice papr", "office paper"),
        ("aluminium", "aluminium foil"),
        ("steel", "steel sheet"),
        ("coton", "cotton"),
    ] {
        let error = Material::named(wrong).unwrap_err();
        assert_eq!(error.names[0], right, "{wrong}");
        assert_eq!(error.names.len(), Material::names().count());
        let message = error.to_string();
        assert!(
            message.contains(wrong) && message.contains("denim"),
            "{message}"
        );
    }
}

/// A strip as a beam: the rigidity of a plate per width is that of a beam of Poisson's ratio zero, and larger
/// by `1 / (1 - nu^2)` otherwise; the radius of gyration of a rectangle is `h / sqrt(12)`.
#[test]
fn a_plate_has_the_rigidity_of_its_thickness() {
    for (name, thickness, youngs) in PLATES {
        let material = Material::named(name).unwrap();
        assert!((material.stiffness / (youngs * thickness) - 1.0).abs() < 1e-12);
        let gyration =
            (material.rigidity * (1.0 - material.poisson.powi(2)) / material.stiffness).sqrt();
        assert!(
            (gyration * 12_f64.sqrt() / thickness - 1.0).abs() < 1e-12,
            "{name}"
        );
    }
    let steel = Material::isotropic(Isotropic {
        youngs: 2.1e11,
        thickness: 5e-4,
        density: 7850.0,
        poisson: 0.3,
    });
    let yielding = steel.map(|m| m.with_yield_stress(5e-4, 2.35e8));
    assert_eq!(yielding, Ok(Material::steel_sheet()));
    // Half a millimetre of steel: 3.925 kg/m2 and 2.4038 N m.
    assert!((Material::steel_sheet().density - 3.925).abs() < 1e-12);
    assert!((Material::steel_sheet().rigidity - 2.403_846).abs() < 1e-6);
}

/// Fibrous sheets are about as stiff in bending as plates of their stiffness and of the thickness of their
/// form, or softer; board, whose outer plies are the stiff ones, is stiffer by a tenth. The rigidity of
/// office paper is that of its stiffer direction.
#[test]
fn fibrous_sheets_are_about_as_stiff_as_plates_or_softer() {
    for (name, thickness) in [
        ("card", 3e-4),
        ("newsprint", 7e-5),
        ("kraft paper", 1.1e-4),
        ("tissue paper", 3e-5),
        ("tracing paper", 7.5e-5),
        ("leather", 1.2e-3),
    ] {
        let material = Material::named(name).unwrap();
        let plate =
            material.stiffness * thickness * thickness / (12.0 * (1.0 - material.poisson.powi(2)));
        let share = material.rigidity / plate;
        assert!((0.1..1.15).contains(&share), "{name}: {share}");
    }
}

#[test]
fn a_material_makes_an_elastic_sheet() {
    let elastic = |material: Material| {
        let sheet = isosheet_mesh::generate::isotropic_square(1, 0.2).unwrap();
        let plate = PlateBending::new(&sheet, &material).unwrap();
        material.elastic_sheet(&sheet, &plate)
    };
    let rubber = elastic(Material::rubber_sheet()).unwrap();
    assert_eq!(rubber.limit(), 0.2);
    assert!((rubber.stiffness() - 1800.0).abs() < 1e-9);
    let mut paper = Material::office_paper();
    paper.strain_limit = 0.7;
    assert!(elastic(paper).is_err());
}

#[test]
fn numbers_without_sense_are_refused_by_name() {
    let wrong = |change: fn(&mut Material)| {
        let mut material = Material::cotton();
        change(&mut material);
        material.validate().unwrap_err().name
    };
    assert_eq!(wrong(|m| m.density = 0.0), "density");
    assert_eq!(wrong(|m| m.stiffness = f64::NAN), "stiffness");
    assert_eq!(wrong(|m| m.rigidity = -1.0), "rigidity");
    assert_eq!(wrong(|m| m.poisson = 0.6), "poisson");
    assert_eq!(wrong(|m| m.strain_limit = 0.0), "strain_limit");
    let isotropic = |youngs, thickness, density, poisson| {
        Material::isotropic(Isotropic {
            youngs,
            thickness,
            density,
            poisson,
        })
        .map_err(|e| e.name)
    };
    assert_eq!(isotropic(0.0, 1e-3, 1e3, 0.3), Err("youngs"));
    assert_eq!(isotropic(1e9, f64::INFINITY, 1e3, 0.3), Err("thickness"));
    assert_eq!(isotropic(1e9, 1e-3, -1e3, 0.3), Err("density"));
    assert_eq!(isotropic(1e9, 1e-3, 1e3, 1.0), Err("poisson"));
    // Numbers that have a sense each, of a sheet that has none.
    assert_eq!(isotropic(1.0, 1e-12, 1e3, 0.3), Err("stiffness"));
    assert_eq!(isotropic(1e15, 1e12, 1e-3, 0.3), Err("stiffness"));
}

/// A section that has yielded throughout: `s h^2 / 4`, and a hundredth of the slope after that. Of paper the
/// curvature at the yield is that of an elastic limit of 0.75 % at the surface, three halves of that of its
/// tensile curve.
#[test]
fn papers_and_metals_say_when_they_yield() {
    let steel = Material::steel_sheet();
    let Yield {
        moment, hardening, ..
    } = steel.yields.unwrap();
    assert!((moment - 14.6875).abs() < 1e-9);
    let slope = steel.rigidity * hardening / (steel.rigidity + hardening);
    assert!((slope / steel.rigidity - 0.01).abs() < 1e-12);
    for (name, thickness) in [("office paper", 1e-4), ("card", 3e-4), ("newsprint", 7e-5)] {
        let paper = Material::named(name).unwrap();
        let Yield {
            moment, hardening, ..
        } = paper.yields.unwrap();
        let strain = 0.5 * thickness * moment / paper.rigidity;
        assert!((strain - 7.5e-3).abs() < 1e-12, "{name}: {strain}");
        let slope = paper.rigidity * hardening / (paper.rigidity + hardening);
        assert!((slope / paper.rigidity - 0.25).abs() < 1e-12, "{name}");
    }
    assert_eq!(Material::cotton().yields, None);
}
