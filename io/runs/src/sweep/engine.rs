//! Other programs that run a sweep, and what they are given.

use super::Sweep;
use super::shell::shell_word;

/// A program that runs the lines of a sweep.
///
/// None of them has to remember which runs are done: a line of a complete run ends at once, and that of a
/// run that was stopped continues it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepRunner {
    /// GNU parallel: a line for the shell.
    Parallel,
    /// Slurm: the script of a job array.
    Slurm,
    /// Snakemake: a Snakefile.
    Snakemake,
}

impl SweepRunner {
    /// The text for this program, which runs the lines of the file of commands.
    pub fn text(self, sweep: &Sweep) -> String {
        match self {
            Self::Parallel => {
                let commands = shell_word(&sweep.commands_path());
                format!("parallel --arg-file {commands}\n")
            }
            Self::Slurm => slurm(sweep),
            Self::Snakemake => snakemake(sweep),
        }
    }
}

/// The script: task k runs line k + 1. A task that is requeued continues its run.
fn slurm(sweep: &Sweep) -> String {
    let (commands, last) = (shell_word(&sweep.commands_path()), sweep.len() - 1);
    format!(
        "\
#!/bin/sh
#SBATCH --job-name=isosheet
#SBATCH --array=0-{last}
#SBATCH --cpus-per-task=1
#SBATCH --requeue
#SBATCH --open-mode=append
eval \"$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" {commands})\"
"
    )
}

/// The Snakefile. It marks finished runs by files of its own, since Snakemake removes the output of a job
/// before it repeats the job, and a run needs its files to go on.
fn snakemake(sweep: &Sweep) -> String {
    let folder = python_string(sweep.folder_text());
    let commands = python_string(&sweep.commands_path());
    format!(
        "\
# After a kill: snakemake --unlock, then the same line with --rerun-incomplete.
workdir: {folder}

with open({commands}) as lines:
    COMMANDS = {{f\"{{k:03}}\": line.rstrip(\"\\n\") for k, line in enumerate(lines)}}

rule all:
    input:
        [f\"{{run}}.done\" for run in COMMANDS],

rule simulate:
    output:
        touch(\"{{run}}.done\"),
    params:
        command=lambda wildcards: COMMANDS[wildcards.run],
    shell:
        \"{{params.command}}\"
"
    )
}

/// A string of Python: the escapes of JSON are Python's too.
fn python_string(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
