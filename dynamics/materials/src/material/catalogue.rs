//! Materials with names, and where their numbers are from.
//!
//! Metals and films are isotropic plates: their numbers follow from Young's modulus, thickness and density,
//! for which handbooks and data sheets agree to a few per cent. Paper, cloth and leather differ from sort to
//! sort by a factor of two, and from direction to direction as well: the numbers are typical ones.

use super::{Directions, Isotropic, Material};
use crate::plasticity::Yield;
use isosheet_mesh::Advice;

/// A material of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NamedMaterial {
    /// Its name.
    pub name: &'static str,
    /// What the sheet is: mass, thickness, kind.
    pub form: &'static str,
    /// Where the numbers are from.
    pub source: &'static str,
    /// The numbers.
    pub material: Material,
}

/// A name that no material has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no material has the name \"{name}\"; the names, nearest first, are {}", names.join(", "))]
pub struct UnknownMaterial {
    /// The name that was asked for.
    pub name: String,
    /// The names of all materials, the most similar ones first.
    pub names: Vec<&'static str>,
}

impl Advice for UnknownMaterial {
    fn advice(&self) -> Option<&'static str> {
        Some("choose one of them, or give the numbers of your own material")
    }
}

impl Material {
    /// The material of a name of the catalogue, such as `office paper`. Capital letters, and `-` or `_` for a
    /// space, make no difference.
    ///
    /// # Errors
    /// [`UnknownMaterial`], with all names.
    pub fn named(name: &str) -> Result<Self, UnknownMaterial> {
        let wanted = plain(name);
        let found = Self::catalogue().iter().find(|m| plain(m.name) == wanted);
        match found {
            Some(found) => Ok(found.material),
            None => {
                let mut names: Vec<&'static str> = Self::names().collect();
                names.sort_by(|a, b| {
                    let likeness = |name| strsim::jaro_winkler(&plain(name), &wanted);
                    likeness(b).total_cmp(&likeness(a))
                });
                Err(UnknownMaterial {
                    name: name.to_owned(),
                    names,
                })
            }
        }
    }

    /// The names of all materials.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Self::catalogue().iter().map(|m| m.name)
    }

    /// All materials that have a name.
    pub fn catalogue() -> &'static [NamedMaterial] {
        ALL
    }
}

/// A name as it is compared.
pub(super) fn plain(name: &str) -> String {
    let name = name.trim().to_lowercase().replace(['-', '_'], " ");
    name.replace("aluminum", "aluminium")
}

/// Makes the constructors of materials, and [`ALL`] of the same text.
macro_rules! catalogue {
    ($($constructor:ident: $name:literal, $form:literal, $material:expr, $source:literal;)+) => {
        impl Material {
            $(
                #[doc = concat!("`", $name, "`: ", $form, ".")]
                #[doc = ""]
                #[doc = $source]
                #[allow(clippy::doc_markdown, reason = "names of firms")]
                pub const fn $constructor() -> Self {
                    $material
                }
            )+
        }

        /// All of them, in groups.
        const ALL: &[NamedMaterial] = &[
            $(NamedMaterial {
                name: $name,
                form: $form,
                source: $source,
                material: Material::$constructor(),
            },)+
        ];
    };
}

/// Fibrous materials: density (kg/m2), membrane stiffness (N/m) and rigidity (N m) were measured each by
/// itself.
const fn fibrous(density: f64, stiffness: f64, rigidity: f64, poisson: f64) -> Material {
    Material {
        density,
        stiffness,
        rigidity,
        poisson,
        strain_limit: Material::STRAIN_LIMIT,
        yields: None,
        directions: None,
    }
}

/// A plate: Young's modulus (Pa), thickness (m), density (kg/m3), Poisson's ratio.
const fn plate(youngs: f64, thickness: f64, density: f64, poisson: f64) -> Material {
    let material = Isotropic {
        youngs,
        thickness,
        density,
        poisson,
    };
    material.sheet()
}

/// Paper of a thickness (m). Its moment is that of a section that has yielded in the whole of its thickness,
/// `3 D e / h` with the elastic limit `e` = 0.5 % of tensile curves, and grows after that with a quarter of
/// the slope before, `D H / (D + H) = D / 4`.
const fn creasing(paper: Material, thickness: f64) -> Material {
    let yields = Yield {
        moment: 3.0 * paper.rigidity * 5e-3 / thickness,
        hardening: paper.rigidity / 3.0,
        layers: Yield::LAYERS,
    };
    Material {
        yields: Some(yields),
        ..paper
    }
}

const fn stretching(material: Material, strain_limit: f64) -> Material {
    Material {
        strain_limit,
        ..material
    }
}

const fn with_directions(material: Material, directions: Directions) -> Material {
    Material {
        directions: Some(directions),
        ..material
    }
}

catalogue! {
    office_paper: "office paper", "uncoated copy paper, 80 g/m2, 0.1 mm",
        with_directions(creasing(fibrous(0.08, 3e5, 5e-4, 0.3), 1e-4), Directions::of_paper(3.16e5, 3.16e-4, 1.58)),
        "Mass: grammage as sold (ISO 536). Membrane stiffness: typical tensile stiffness (ISO 1924-3), between about \
         5e5 N/m in the machine direction and 2e5 N/m across. Rigidity: typical bending stiffness (ISO 5628) in the \
         machine direction, along which A4 sheets are long; across it is about 2e-4 N m. K. Niskanen (ed.), \
         Mechanics of Paper Products, De Gruyter 2012. Poisson's ratio: 0.29 as the geometric mean of both \
         directions, G. A. Baum, D. C. Brennan and C. C. Habeger, Tappi 64(8), 97-101, 1981. Yield: assumed, from typical \
         tensile curves (ISO 1924-3), which bend at 0.5 % to a quarter of their slope, between a sixth across and two \
         fifths in the machine direction. Directions: these ratios of 2.5, with Baum's estimate of the shear modulus, 0.387 \
         (E1 E2)^(1/2).";
    card: "card", "solid bleached board, 250 g/m2, 0.3 mm",
        with_directions(creasing(fibrous(0.25, 1.1e6, 1e-2, 0.3), 3e-4), Directions::of_paper(1.1e6, 1e-2, 1.5)),
        "Mass: grammage as sold (ISO 536). Membrane stiffness: typical tensile stiffness index of 4.5 kN m/g (ISO \
         1924-3) times the grammage. Rigidity: typical bending stiffness (ISO 5628), between about 1.5e-2 N m in the \
         machine direction and 7e-3 N m across. K. Niskanen (ed.), Mechanics of Paper Products, De Gruyter 2012; \
         Poisson's ratio, shear and yield as for office paper. Directions: a ratio of 2.25.";
    newsprint: "newsprint", "newspaper, 45 g/m2, 0.07 mm",
        with_directions(creasing(fibrous(0.045, 1.6e5, 6e-5, 0.3), 7e-5), Directions::of_paper(1.6e5, 6e-5, 1.7)),
        "Mass: grammage as sold (ISO 536). Membrane stiffness: typical tensile stiffness index of 3.5 kN m/g (ISO \
         1924-3) times the grammage. Rigidity: typical, eight tenths of that of a plate of this stiffness and \
         thickness. K. Niskanen (ed.), Mechanics of Paper Products, De Gruyter 2012; Poisson's ratio, shear and yield as for \
         office paper. Directions: a ratio of 3, typical of fast machines.";
    kraft_paper: "kraft paper", "wrapping paper, 80 g/m2, 0.11 mm",
        with_directions(creasing(fibrous(0.08, 4e5, 4e-4, 0.3), 1.1e-4), Directions::of_paper(4e5, 4e-4, 1.4)),
        "Mass: grammage as sold (ISO 536). Membrane stiffness: typical tensile stiffness index of 5 kN m/g (ISO \
         1924-3), long fibres, times the grammage. Rigidity: typical, nine tenths of that of a plate of this \
         stiffness and thickness. K. Niskanen (ed.), Mechanics of Paper Products, De Gruyter 2012; Poisson's ratio, shear and \
         yield as for office paper. Directions: a ratio of 2.";
    tissue_paper: "tissue paper", "smooth wrapping tissue, 18 g/m2, 0.03 mm",
        fibrous(0.018, 6e4, 4e-6, 0.3),
        "Mass: grammage as sold (ISO 536). Membrane stiffness: typical tensile stiffness index of 3.5 kN m/g (ISO \
         1924-3) times the grammage. Rigidity: eight tenths of that of a plate of this stiffness and thickness, as it \
         is below what ISO 5628 measures. Creped tissue (handkerchiefs) is many times softer. Poisson's ratio as for \
         office paper.";
    tracing_paper: "tracing paper", "natural tracing paper, 90 g/m2, 0.075 mm",
        fibrous(0.09, 5e5, 2.3e-4, 0.3),
        "Mass: grammage as sold (ISO 536). Membrane stiffness: typical tensile stiffness index of 5.5 kN m/g (ISO \
         1924-3) of highly beaten pulp, times the grammage. Rigidity: nine tenths of that of a plate of this \
         stiffness and thickness, which is nearly free of pores. Poisson's ratio as for office paper.";
    pet_film: "PET film", "biaxially oriented polyester, 0.1 mm",
        plate(4.9e9, 1e-4, 1390.0, 0.38),
        "Young's modulus (4.8 GPa along, 5.0 GPa across), density and Poisson's ratio below yield: DuPont Teijin \
         Films, Mylar polyester film, Product Information H-37232-3, Physical-Thermal Properties.";
    polyimide_film: "polyimide film", "0.05 mm",
        plate(2.5e9, 5e-5, 1420.0, 0.34),
        "Young's modulus, density and Poisson's ratio: DuPont, Kapton HN polyimide film, Technical Data Sheet.";
    polycarbonate_film: "polycarbonate film", "0.25 mm",
        plate(2.2e9, 2.5e-4, 1200.0, 0.37),
        "Young's modulus (ISO 527) and density: Covestro, Makrofol DE, Product Datasheet 2013. Poisson's ratio: \
         typical, J. A. Brydson, Plastics Materials, 7th ed., Butterworth-Heinemann 1999.";
    acetate_film: "acetate film", "cellulose acetate, 0.1 mm",
        plate(2.0e9, 1e-4, 1300.0, 0.4),
        "Typical values of plasticised cellulose diacetate: J. A. Brydson, Plastics Materials, 7th ed., \
         Butterworth-Heinemann 1999.";
    polyethylene_film: "polyethylene film", "low density (bags), 0.05 mm",
        plate(2.5e8, 5e-5, 920.0, 0.45),
        "Young's modulus: the middle of 0.2 to 0.3 GPa, and density of low-density polyethylene: J. A. Brydson, \
         Plastics Materials, 7th ed., Butterworth-Heinemann 1999. Poisson's ratio: typical.";
    aluminium_foil: "aluminium foil", "household foil, alloy 8011, 0.016 mm",
        plate(6.9e10, 1.6e-5, 2700.0, 0.33).with_yield_stress(1.6e-5, 3.5e7),
        "Young's modulus, density and Poisson's ratio: ASM Handbook Vol. 2, Properties and Selection: Nonferrous \
         Alloys, ASM International 1990. Thickness: as sold. Yield: 35 MPa, a typical value of soft foil \
         (temper O), with the hardening of EN 1993-1-5, C.6.";
    aluminium_sheet: "aluminium sheet", "0.5 mm",
        plate(6.9e10, 5e-4, 2700.0, 0.33).with_yield_stress(5e-4, 8.5e7),
        "Young's modulus, density and Poisson's ratio: ASM Handbook Vol. 2, Properties and Selection: Nonferrous \
         Alloys, ASM International 1990. Yield: 85 MPa, the least proof strength of EN AW-1050A, half hard (H14), EN \
         485-2; harder alloys have up to 300 MPa. Hardening: as EN 1993-1-5, C.6, has it for steel.";
    steel_sheet: "steel sheet", "0.5 mm",
        plate(2.1e11, 5e-4, 7850.0, 0.3).with_yield_stress(5e-4, 2.35e8),
        "Young's modulus and Poisson's ratio: EN 1993-1-1 (Eurocode 3), 3.2.6. Density: EN 1991-1-1, Table A.4. Yield: \
         235 MPa, S235 of EN 1993-1-1, Table 3.1, with the hardening of EN 1993-1-5, C.6.";
    copper_foil: "copper foil", "of circuit boards, 0.035 mm",
        plate(1.17e11, 3.5e-5, 8930.0, 0.34),
        "Young's modulus, density and Poisson's ratio of copper C11000: ASM Handbook Vol. 2, Properties and \
         Selection: Nonferrous Alloys, ASM International 1990. Thickness: 1 ounce on a square foot. Electrodeposited \
         foils are softer by up to a third.";
    copper_sheet: "copper sheet", "0.5 mm",
        plate(1.17e11, 5e-4, 8930.0, 0.34).with_yield_stress(5e-4, 6.9e7),
        "Young's modulus, density and Poisson's ratio of copper C11000: ASM Handbook Vol. 2, Properties and \
         Selection: Nonferrous Alloys, ASM International 1990. Yield: 69 MPa, annealed, of the same handbook; hard \
         copper has up to 300 MPa. Hardening: as EN 1993-1-5, C.6, has it for steel.";
    brass_shim: "brass shim", "cartridge brass C26000, 0.1 mm",
        plate(1.12e11, 1e-4, 8530.0, 0.34),
        "Young's modulus and density: Olin Brass, C26000 Cartridge Brass, Alloy Data. Poisson's ratio: ASM Handbook \
         Vol. 2, Properties and Selection: Nonferrous Alloys, ASM International 1990.";
    cotton: "cotton", "shirting, plain weave, 120 g/m2",
        with_directions(fibrous(0.12, 1.5e4, 7e-6, 0.2), Directions::of_cloth([2.2e4, 1e4, 50.0], 0.2, [9e-6, 5.4e-6, 7e-6])),
        "Typical of cotton shirtings on the instruments of Kawabata (KES-F): a bending rigidity of 0.07 gf cm2/cm, \
         and an extension of 3 % by 500 gf/cm. S. Kawabata, The Standardization and Analysis of Hand Evaluation, 2nd \
         ed., Textile Machinery Society of Japan, Osaka 1980; B. P. Saville, Physical Testing of Textiles, Woodhead \
         1999. Poisson's ratio: assumed. Directions: warp and weft by extensions of 2 and 5 %, typical; shear 0.9 gf/cm for \
         a degree, typical of shirtings in the same books. Twist: assumed.";
    silk: "silk", "habotai, plain weave, 8 momme (35 g/m2)",
        fibrous(0.035, 2e4, 2e-6, 0.2),
        "Typical of light silks on the instruments of Kawabata (KES-F): a bending rigidity of 0.02 gf cm2/cm, and an \
         extension of 2.5 % by 500 gf/cm. S. Kawabata, The Standardization and Analysis of Hand Evaluation, 2nd ed., \
         Textile Machinery Society of Japan, Osaka 1980. Poisson's ratio: assumed.";
    wool: "wool", "worsted suiting, 200 g/m2",
        with_directions(fibrous(0.2, 1e4, 1e-5, 0.2), Directions::of_cloth([1.25e4, 8e3, 40.0], 0.2, [1.2e-5, 8.4e-6, 1e-5])),
        "Typical of suitings: a bending rigidity of 1e-5 N m, and an extension of 5 % by 500 gf/cm. S. Kawabata, The \
         Standardization and Analysis of Hand Evaluation, 2nd ed., Textile Machinery Society of Japan, Osaka 1980; A. \
         De Boos and D. Tester, SiroFAST: Fabric Assurance by Simple Testing, CSIRO Report WT92.02, 1994, whose suitings have \
         shear rigidities of 30 to 80 N/m. Poisson's ratio, twist and the ratio of warp and weft: assumed.";
    denim: "denim", "washed, twill, 12 oz (400 g/m2)",
        fibrous(0.4, 1.2e4, 5e-5, 0.2),
        "Typical of washed denim: a bending rigidity of 0.5 gf cm2/cm, and an extension of 4 % by 500 gf/cm; light \
         denim has 0.14 to 0.23 gf cm2/cm and 5 % (Journal of Textiles 2016, 4614168, Table 5), unwashed denim more \
         than 1 gf cm2/cm. B. P. Saville, Physical Testing of Textiles, Woodhead 1999. Poisson's ratio: assumed.";
    nylon_ripstop: "nylon ripstop", "parachute cloth, 37 g/m2, 0.08 mm",
        fibrous(0.037, 2.5e4, 3e-6, 0.2),
        "Mass and thickness: specification MIL-C-7020, type I. Membrane stiffness: its strength of 42 lbf/in at an \
         elongation of about 30 %. Rigidity: typical of light woven nylon, 0.03 gf cm2/cm. Poisson's ratio: assumed.";
    leather: "leather", "soft upholstery leather, 1.2 mm",
        fibrous(1.0, 3e4, 1e-3, 0.4),
        "Typical values, Young's modulus being 25 MPa at small strains and the rigidity that of bending with the \
         grain outside, a quarter of that of a plate; leathers differ by a factor of three. A. Mihai, A. Seul, A. \
         Curteza and M. Costea, Materials 15, 5107, 2022.";
    rubber_sheet: "rubber sheet", "natural rubber, 45 Shore A, 1 mm",
        stretching(plate(1.8e6, 1e-3, 950.0, 0.5), 0.2),
        "Young's modulus by hardness: A. N. Gent (ed.), Engineering with Rubber, 3rd ed., Hanser 2012. Density of \
         the unfilled compound: MatWeb, Natural Rubber, Vulcanized. Poisson's ratio: incompressible. Strain limit: \
         the range in which rubber is nearly linear.";
}
