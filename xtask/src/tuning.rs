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
use std::sync::LazyLock;

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
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kind {
    name: String,
    /// A file of `xtask/scenes`, or a kind of `isosheet new`.
    scene: String,
    #[serde(default)]
    edits: Vec<String>,
    /// Size of the displacements as a part of the mean edge length.
    perturbation: f64,
    steps: usize,
}

/// The file of the kinds.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct KindsFile {
    kind: Vec<Kind>,
}

static KINDS: LazyLock<Vec<Kind>> = LazyLock::new(|| {
    let contents: Result<KindsFile, _> = toml::from_str(include_str!("tuning/kinds.toml"));
    contents
        .unwrap_or_else(|error| panic!("kinds.toml: {error}"))
        .kind
});

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
        for kind in KINDS.iter() {
            let mut measured = Measured::default();
            for seed in 1..=starts {
                kind.run(seed, tuning, store.effort, &mut measured)
                    .with_context(|| kind.name.clone())?;
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
        let mut edits = self.edits.clone();
        edits.push(displaced(self.perturbation, seed));
        let scene = FigureScene::named(&self.scene, &self.name, &edits)?;
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
            "kind" => row.0.name.as_str(),
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
    let ratio = |(kind, (b, c)): (&'static Kind, (&Measured, &Measured))| {
        let per_step = |m: &Measured| of(&m.cost) / m.cost.steps.max(1) as f64;
        (per_step(c) / per_step(b), kind.name.as_str())
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
