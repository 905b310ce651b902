//! The page of all materials with their sources, made of the catalogue.

use isosheet_dynamics::Material;
use isosheet_mesh::wording::brief;

const INTRODUCTION: &str = "\
# Materials

A scene names what its sheet is made of:

```toml
version = 1

[sheet]
mesh = { rectangle = { width = 0.21, height = 0.03, columns = 28, rows = 4 } }
material = \"office paper\"
```

The name gives the sheet its mass, membrane stiffness, flexural rigidity, Poisson's ratio and largest strain,
and makes it elastic. Keys beside it, such as `density` or `bending`, override these values.
`isometry = \"rods\"` beside it makes a sheet of rigid rods with the mass and bending stiffness of the material.
`isosheet check` prints the numbers. Another metal or film is `material = { youngs = 2.1e11, thickness = 5e-4,
density = 7850, poisson = 0.3 }`. Its mass is `density thickness`, its membrane stiffness
`E h = youngs thickness` and its rigidity `D = youngs thickness^3 / (12 (1 - poisson^2))`.

In Rust, `Material::named(\"office paper\")` and `Material::office_paper()` have these numbers, and
`Material::isotropic` computes the numbers of a plate.

**Know before use.** The numbers of metals and films are good to a few per cent for the thickness given, which
is a common one. The numbers of paper, cloth and leather are typical: sorts differ by a factor of two, and
moisture softens paper. The rigidity of office paper, card, cloth and leather comes from bending tests: it
does not follow from the thickness, since fibres move against one another. The rigidity of the other papers is
eight to nine tenths of the rigidity of a plate. The sources say which numbers are typical or assumed. The
strain limit keeps strain invisible where a mesh is too coarse for its bends; materials yield or tear at other
strains.

**Directions.** Paper is about twice as stiff along the direction in which it was made as across, and woven
cloth is many times softer in shear than along its yarns. A sheet has directions if it names one,
`direction = [1, 0, 0]`, in the frame of its mesh: the machine direction of paper, the warp of cloth. The
second table has the numbers. Without the key a sheet has the numbers of the first table in all directions,
and cloth wraps round bodies less easily than it should. Cloth with a direction has a strain limit of 20 %, a
shear of 16 degrees, in place of 5 %. The page [How a sheet bends](bends.md) has the formulas, and materials
of your own.

**Yield.** A material with a moment `M_y` yields in bending if a scene sets `sheet.yield = {}`: sharp bends
stay, and spring back by the curvature `M_y / D`. `H` is the hardening. A section yields from its faces
inwards, from two thirds of `M_y` on; at `M_y` its whole thickness has yielded. By default each half of it has
11 layers for this. `yield = { layers = 4 }` is coarser; with `layers = 1` the whole thickness yields at once,
at `M_y`. [The theory](theory.md) has the formulas. `M_y` varies more than all other numbers, for a metal with
alloy and temper. The key `yield = { moment = ..., hardening = ... }` overrides it, and `yield_stress` among
the numbers of a material computes `M_y = yield_stress thickness^2 / 4`.

";

/// The page of all materials in Markdown: a table of the numbers, and their sources.
pub(super) fn page() -> String {
    let mut page = String::from(INTRODUCTION);
    page.push_str(
        "| name | sheet | mass, kg/m2 | `E h`, N/m | `D`, N m | Poisson's ratio | largest strain, % | `M_y`, N m/m | `H`, N m |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for named in Material::catalogue() {
        let m = named.material;
        let [moment, hardening] = match m.yields {
            Some(yields) => [yields.moment, yields.hardening].map(|value| brief(value).to_string()),
            None => [String::new(), String::new()],
        };
        page.push_str(&format!(
            "| `{}` | {} | {} | {} | {} | {} | {} | {moment} | {hardening} |\n",
            named.name,
            named.form,
            brief(m.density),
            brief(m.stiffness),
            brief(m.rigidity),
            brief(m.poisson),
            brief(100.0 * m.strain_limit)
        ));
    }
    page.push_str(
        "\n## Along a direction and across it\n\n\
         | name | `E1 h`, N/m | `E2 h`, N/m | `G12 h`, N/m | `nu12` | `D11`, N m | `D22`, N m | `D12`, N m | `D66`, N m |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for named in Material::catalogue() {
        let Some(own) = named.material.directions else {
            continue;
        };
        let plane = [own.along, own.across, own.shear, own.poisson];
        let bends = [own.bend_along, own.bend_across, own.coupling, own.twist];
        let numbers = plane.into_iter().chain(bends);
        let numbers: Vec<String> = numbers.map(|n| brief(n).to_string()).collect();
        page.push_str(&format!("| `{}` | {} |\n", named.name, numbers.join(" | ")));
    }
    page.push_str("\n## Sources\n\n");
    for named in Material::catalogue() {
        page.push_str(&format!("- **{}**: {}\n", named.name, named.source));
    }
    page.push_str(
        "\nOne gf cm2/cm, the unit of bending rigidity of the instruments of Kawabata, is 9.8e-5 N m; 500 gf/cm are \
         490 N/m. This page is made of the catalogue in `dynamics/materials/src/`.\n",
    );
    page
}
