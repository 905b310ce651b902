//! `tuning`: what each constant of a damped step is worth, measured by changing it.

use crate::progress::Progress;
use crate::report::{Cost, Effort, Options, Page, Part, Table, columns, excerpt, machine};
use crate::runs::{FigureScene, Plan, displaced, scene_fingerprint, unseen};
use crate::store::Store;
use anyhow::{Context, Result};
use clap::Args;
use isosheet_dynamics::{Constant, Tuning};
use maud::html;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Arguments of `tuning`.
#[derive(Debug, Args)]
pub(crate) struct TuningArgs {
    #[command(flatten)]
    options: Options,

    /// Only these constants, such as `armijo,slow`; without a name only what the kinds cost with the
    /// constants as they are
    #[arg(long, value_name = "NAMES", num_args = 0.., value_delimiter = ',', value_parser = constant)]
    constants: Option<Vec<&'static Constant>>,
}

/// The constant of a name.
fn constant(name: &str) -> Result<&'static Constant, String> {
    let found = Tuning::TABLE.iter().find(|c| c.name == name);
    found.ok_or_else(|| {
        let names: Vec<&str> = Tuning::TABLE.iter().map(|c| c.name).collect();
        format!("the constants are {}", names.join(", "))
    })
}

/// A kind of scene, of which each start has other small displacements.
struct Kind {
    name: &'static str,
    /// A file of `xtask/scenes`, or a kind of `isosheet new`.
    scene: &'static str,
    edits: &'static [&'static str],
    /// Size of the displacements as a part of the mean edge length.
    perturbation: f64,
    steps: usize,
}

/// All kinds.
const KINDS: [Kind; 15] = [
    Kind {
        name: "hanging",
        scene: "fig12",
        edits: &["sheet.mesh.square.level=3", "contact={self_contact=false}"],
        perturbation: 1e-3,
        steps: 60,
    },
    Kind {
        name: "bending",
        scene: "fig12",
        edits: &[
            "contact={self_contact=false}",
            "sheet.bending={hinges={rigidity=5e-4}}",
        ],
        perturbation: 1e-3,
        steps: 60,
    },
    Kind {
        name: "drape",
        scene: "fig15",
        edits: &["contact.self_contact=false"],
        perturbation: 1e-3,
        steps: 45,
    },
    Kind {
        name: "drape, itself",
        scene: "fig14",
        edits: &[
            "sheet.mesh.rectangle.columns=8",
            "sheet.mesh.rectangle.rows=8",
        ],
        perturbation: 1e-3,
        steps: 60,
    },
    Kind {
        name: "feed",
        scene: "fig16",
        edits: &[],
        perturbation: 1e-4,
        steps: 160,
    },
    Kind {
        name: "stamp",
        scene: "fig13",
        edits: &["sheet.mesh.square.level=2"],
        perturbation: 1e-4,
        steps: 90,
    },
    Kind {
        name: "elastic clamp",
        scene: "clamp",
        edits: &[],
        perturbation: 1e-4,
        steps: 60,
    },
    Kind {
        name: "crease pattern",
        scene: "fig17",
        edits: &["sheet.mesh.miura.columns=6", "sheet.mesh.miura.rows=6"],
        perturbation: 1e-4,
        steps: 60,
    },
    Kind {
        name: "conservative",
        scene: "fig12",
        edits: &[
            "contact={self_contact=false}",
            "sheet.damping=0.0",
            "method={integrator=\"energy_momentum\",step=0.002,fallback={implicit_euler={}}}",
        ],
        perturbation: 0.1,
        steps: 60,
    },
    // Faces whose altitude is 5e-4 of their longest side.
    Kind {
        name: "slivers",
        scene: "fig12",
        edits: &[
            "sheet.mesh={rectangle={width=0.21,height=1e-4,columns=8,rows=8}}",
            "contact={self_contact=false}",
        ],
        perturbation: 1e-7,
        steps: 30,
    },
    // A half that is 1e3 times as heavy as the other.
    Kind {
        name: "heavy part",
        scene: "fig12",
        edits: &[
            "weight=[{at={half_space={point=[0.105,0,0],normal=[1,0,0]}},mass=1.764}]",
            "contact={self_contact=false}",
        ],
        perturbation: 1e-2,
        steps: 240,
    },
    Kind {
        name: "tiny steps",
        scene: "fig12",
        edits: &[
            "sheet.mesh.square.level=3",
            "contact={self_contact=false}",
            "method.step=1e-4",
        ],
        perturbation: 1e-3,
        steps: 120,
    },
    Kind {
        name: "strip on edge",
        scene: "fig12",
        edits: &[
            "sheet.mesh={rectangle={width=0.21,height=0.02625,columns=16,rows=2}}",
            "support=[{at={box={min=[-1,-1,-1],max=[0,1,1]}}}]",
            "forces.gravity=[0,-9.8,0]",
            "contact={self_contact=false}",
        ],
        perturbation: 1e-6,
        steps: 240,
    },
    Kind {
        name: "flat on a table",
        scene: "fig12",
        edits: &[
            "sheet.mesh.square.level=3",
            "support=[]",
            "obstacle=[{shape=\"half_space\",pose={position=[0,0,-1e-4]},friction=0.3}]",
            "contact={self_contact=false}",
        ],
        perturbation: 1e-6,
        steps: 5,
    },
    // Aluminium of 1 mm.
    Kind {
        name: "sheet metal",
        scene: "stamp",
        edits: &[
            "sheet.mesh.rectangle.columns=18",
            "sheet.mesh.rectangle.rows=6",
            "sheet.material.thickness=1e-3",
        ],
        perturbation: 1e-4,
        steps: 120,
    },
];

/// What all starts of a kind cost.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Measured {
    cost: Cost,
    /// Runs that ended early.
    failures: usize,
}

/// The kinds with one constant changed.
#[derive(Clone, Debug)]
struct Changed {
    constant: &'static Constant,
    /// With half the value, and with twice the value.
    kinds: [Vec<Measured>; 2],
}

/// Runs the command.
pub(crate) fn run(args: &TuningArgs) -> Result<()> {
    let store = args.options.open("tuning")?;
    let starts = store.effort.quick_or(1, 8);
    let base = all_kinds(&store, "as it is", Tuning::default(), starts)?;
    let all: Vec<_> = Tuning::TABLE.iter().collect();
    let constants = match (&args.constants, store.effort) {
        (Some(named), _) => named,
        (None, Effort::Quick) => &all[..1],
        (None, _) => &all[..],
    };
    let change = |constant: &'static Constant| {
        let with = |factor: f64| {
            let mut tuning = Tuning::default();
            *(constant.place)(&mut tuning) *= factor;
            let name = format!("{} x{factor}", constant.name);
            all_kinds(&store, &name, tuning, starts)
        };
        let kinds = [with(0.5)?, with(2.0)?];
        Ok(Changed { constant, kinds })
    };
    let changed: Vec<Changed> = constants
        .iter()
        .copied()
        .map(change)
        .collect::<Result<_>>()?;
    let mut tables = vec![base_table(&base, starts)];
    if !changed.is_empty() {
        tables.push(table(&base, &changed));
    }
    for table in &tables {
        print!("{}", table.text());
        table.write_to(&store.path(&format!("{}.csv", table.name)))?;
    }
    let about = format!(
        "Each constant of the damped methods is halved and doubled over {starts} starts of {} kinds of scene. Runs are chaotic: ratios \
         of a kind that differ from 1 by less than a tenth are noise. Machine: {}.",
        KINDS.len(),
        machine()
    );
    let body = html! { p { (about) } @for table in &tables { (table) } };
    let page = Page {
        heading: "Tuning",
        ..Page::new("isosheet: tuning", body)
    };
    page.write(&store, "index.html")?;
    if args.constants.is_some() {
        return Ok(());
    }
    let parts = vec![
        Part::text("about", &about),
        Part::table("kinds", &tables[0]),
        Part::table("constants", &tables[1]),
    ];
    excerpt::write(&store, "tuning", parts)
}

/// Measures all kinds of scene with some constants.
fn all_kinds(store: &Store, name: &str, tuning: Tuning, starts: u64) -> Result<Vec<Measured>> {
    let file = name.replace(' ', "-");
    let mut unit = store.unit(file, name);
    unit.options["scenes"] = json!(scene_fingerprint()?);
    store.keep(&unit, |_| {
        let bar = Progress::start(name, KINDS.len());
        let mut all = Vec::new();
        for kind in &KINDS {
            let mut measured = Measured::default();
            for seed in 1..=starts {
                kind.run(seed, tuning, store.effort, &mut measured)
                    .with_context(|| kind.name)?;
            }
            all.push(measured);
            bar.step();
        }
        bar.finish("measured");
        Ok(all)
    })
}

impl Kind {
    fn run(&self, seed: u64, tuning: Tuning, effort: Effort, sum: &mut Measured) -> Result<()> {
        let mut edits: Vec<String> = self.edits.iter().map(|&edit| edit.to_owned()).collect();
        edits.push(displaced(self.perturbation, seed));
        let scene = FigureScene::named(self.scene, self.name, &edits)?;
        let mut simulation = scene.setup()?.start()?.with_tuning(tuning)?;
        let time = scene.frame() * effort.quick_or(3, self.steps) as f64;
        let course = Plan::new(scene.frame(), time).run(&mut simulation, &mut unseen)?;
        sum.cost.add_run(&course.cost);
        sum.failures += usize::from(!course.is_good());
        Ok(())
    }
}

fn base_table(base: &[Measured], starts: u64) -> Table {
    Table::of(
        format!("What {starts} starts of each kind cost with the constants as they are."),
        KINDS.iter().zip(base),
        columns! { row;
            "kind" => row.0.name,
            "steps" => row.1.cost.steps,
            "factorisations per step" => row.1.cost.factorisations_per_step(),
            "CPU seconds" => row.1.cost.cpu,
            "failures" => row.1.failures,
        },
    )
    .named("kinds")
}

/// The geometric mean over the kinds of a ratio, and the largest one with its kind.
fn ratios(
    base: &[Measured],
    changed: &[Measured],
    of: impl Fn(&Cost) -> f64,
) -> (f64, f64, &'static str) {
    let ratio = |(kind, (b, c)): (&Kind, (&Measured, &Measured))| {
        let per_step = |m: &Measured| of(&m.cost) / m.cost.steps.max(1) as f64;
        (per_step(c) / per_step(b), kind.name)
    };
    let all: Vec<(f64, &str)> = KINDS
        .iter()
        .zip(base.iter().zip(changed))
        .map(ratio)
        .collect();
    let mean = all.iter().map(|(r, _)| r.ln()).sum::<f64>() / all.len() as f64;
    let distance = |r: &f64| r.ln().abs();
    let far = all
        .iter()
        .max_by(|a, b| distance(&a.0).total_cmp(&distance(&b.0)));
    let (far, name) = far.copied().unwrap_or((1.0, ""));
    (mean.exp(), far, name)
}

fn table(base: &[Measured], changed: &[Changed]) -> Table {
    let factorisations = |kinds: &[Measured]| {
        let (mean, far, kind) = ratios(base, kinds, |cost| cost.factorisations as f64);
        format!("{mean:.2} ({kind} {far:.2})")
    };
    let cpu = |kinds: &[Measured]| format!("{:.2}", ratios(base, kinds, |cost| cost.cpu).0);
    let failures = |of: &[Measured]| of.iter().map(|m| m.failures).sum::<usize>() as i64;
    let more = |kinds: &[Measured]| format!("{:+}", failures(kinds) - failures(base));
    Table::of(
        "The constants, with factorisations a step, CPU seconds a step and failures where a constant is halved and doubled, against those \
         with the constants as they are: geometric means over the kinds, in brackets the kind that differs most.",
        changed,
        columns! { row;
            "constant" => row.constant.name,
            "value" => row.constant.value,
            "factorisations, halved" => factorisations(&row.kinds[0]),
            "doubled" => factorisations(&row.kinds[1]),
            "CPU, halved" => cpu(&row.kinds[0]),
            "CPU, doubled" => cpu(&row.kinds[1]),
            "failures, halved" => more(&row.kinds[0]),
            "failures, doubled" => more(&row.kinds[1]),
            "what it is" => row.constant.reason.trim(),
        },
    )
    .named("constants")
}
