//! The hanging sheet and the tablecloth as other programs did them: figures measured once, on another
//! occasion and machine.

use crate::figures::Table;

/// What the figures are, in words.
pub(crate) const REMARK: &str = "For orientation only: these figures were not measured by this command but once, on another machine with other work \
    running on it, so that only ratios of ten mean something. Each cell: wall seconds for a simulated second, largest relative edge length error, \
    and where known the energy balance as part of the potential energy released or the depth of penetration.";

const ROWS: [[&str; 5]; 13] = [
    [
        "Jolt soft body (XPBD)",
        "60 Hz, 20 iterations",
        "0.0014, 3e-3, −7 %",
        "0.0037, 8e-3, −6 %",
        "0.016, 6e-2, −10 %",
    ],
    [
        "PositionBasedDynamics 2.2 (XPBD)",
        "5 ms, 100 substeps",
        "0.125, 1e-4, −1 %",
        "0.22, 1e-3, −5 %",
        "0.80, 2e-3, −4 %",
    ],
    [
        "MuJoCo 4.0 flex, edge equality",
        "1 ms Euler",
        "0.084, 3e-4",
        "0.31, 3e-3",
        "2.4, 4e-2",
    ],
    [
        "MuJoCo 4.0 flex, elastic",
        "2 ms",
        "0.029, 2e-4, −34 %",
        "0.13, 2e-4, −32 %",
        "0.71, 4e-4, −32 %",
    ],
    [
        "Newton (XPBD / VBD)",
        "CPU",
        "3.1, 3e-3 / 0.17, 1e-3",
        "2.6, 2e-2 / 0.60, 4e-3",
        "4.0, 0.3 / 1.9, 2e-2",
    ],
    [
        "Blender cloth",
        "quality 40, 100 fps",
        "0.37, 4e-6, −16 %",
        "1.9, 2e-6, −86 %",
        "7.8, 4e-6, −96 %",
    ],
    [
        "STARK",
        "2 ms",
        "0.17, 7e-4, −11 %",
        "0.83, 4e-4, −9 %",
        "5.6, 3e-4, −9 %",
    ],
    [
        "Codim-IPC",
        "2 ms",
        "1.6, 4e-4, −10 %",
        "4.1, 5e-4, −9 %",
        "19, 5e-4, −9 %",
    ],
    [
        "ARCSim 0.3.1",
        "2 to 5 ms",
        "0.31, 7e-5, −95 %",
        "",
        "5.1, 1e-4, −95 %",
    ],
    [
        "Exudyn 1.13, rigid rods",
        "generalised-α, index 2, 2 ms",
        "0.49, 1e-14, −0.03 %",
        "blows up",
        "blows up",
    ],
    [
        "Exudyn 1.13, rigid rods",
        "trapezoidal, 2 ms",
        "0.59, 2e-4, 0",
        "15, 8e-4, −0.2 %",
        "97, 3e-3, −0.1 %",
    ],
    [
        "plain RATTLE (C++, Eigen sparse LDL^T)",
        "2 ms",
        "0.020, 1e-12, 5e-5",
        "fails at once",
        "fails",
    ],
    [
        "plain fast projection (same)",
        "5 ms, tolerance 1e-9",
        "0.013, 5e-10, −14 %",
        "0.37, 1e-9, −18 %",
        "0.98, 1e-9, −14 %",
    ],
];

/// The table.
pub(crate) fn table() -> Table {
    Table {
        caption: "The hanging sheet in other programs".into(),
        head: ["program", "settings", "M^1", "M^2", "M^3"]
            .map(str::to_owned)
            .to_vec(),
        rows: ROWS.iter().map(|r| r.map(str::to_owned).to_vec()).collect(),
    }
}

const TABLECLOTH: [[&str; 3]; 6] = [
    ["Jolt soft body (XPBD)", "0.024, 2e-3", "0.17, 8e-3"],
    [
        "PositionBasedDynamics 2.2 (XPBD)",
        "0.18, 4e-3, 6 mm into the table",
        "0.49, 1e-2, 15 mm into the table",
    ],
    [
        "MuJoCo 4.0 flex",
        "0.7 to 1.9, 7e-3 to 2e-2, up to 11 mm in",
        "",
    ],
    [
        "rapier-cloth",
        "0.31, 7e-3; with self-contact 3.9, 1e-2",
        "",
    ],
    ["STARK", "3.1, 1e-3, no penetration", ""],
    ["Codim-IPC", "3.7, 3e-3, no penetration", ""],
];

/// The table of the tablecloth.
pub(crate) fn tablecloth() -> Table {
    Table {
        caption: "The tablecloth in other programs".into(),
        head: ["program", "M^2", "M^3"].map(str::to_owned).to_vec(),
        rows: TABLECLOTH
            .iter()
            .map(|r| r.map(str::to_owned).to_vec())
            .collect(),
    }
}
