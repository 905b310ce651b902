//! What is said of wrong scenes, and edits.

use crate::parse;
use isosheet_mesh::Advice;
use isosheet_scenes::{Key, PlacedProblem, SceneFile, SceneFileError};
use std::fs;
use std::path::Path;

/// A scene of twelve lines that is right but for what an edit does to it.
const RIGHT: &str = "version = 1
[sheet]
mesh = { square = { side = 0.2, level = 1 } }
density = 0.1
[[support]]
at = { vertices = [0] }
[[obstacle]]
shape = { sphere = { radius = 0.1 } }
pose = { position = [0, 0, -1] }
[stop]
time = 0.1
";

fn problems(text: &str) -> Vec<PlacedProblem> {
    let error = match parse(text) {
        Err(SceneFileError::Scene(error)) => error,
        Err(other) => panic!("{other}"),
        Ok(scene) => match scene.build().and_then(|s| s.start()) {
            Err(error) => error,
            Ok(_) => panic!("accepted:\n{text}"),
        },
    };
    // File, marker and text are in the message.
    let shown = error.to_string();
    assert!(
        shown.contains("--> test.toml:") && shown.contains('^'),
        "{shown}"
    );
    error.placed()
}

/// What is replaced by what; line and column, parts of message and remedy.
type Wrong<'a> = (&'a str, &'a str, [usize; 2], &'a str, &'a str);

const WRONG: [Wrong<'_>; 21] = [
    (
        "density = 0.1",
        "densty = 0.1",
        [4, 1],
        "unknown key `densty`",
        "did you mean `density`?",
    ),
    (
        "radius = 0.1",
        "radus = 0.1",
        [8, 22],
        "unknown key `radus`",
        "did you mean `radius`?",
    ),
    (
        "sphere =",
        "sphre =",
        [8, 11],
        "unknown choice `sphre`",
        "did you mean `sphere`?",
    ),
    (
        "sphere = { radius = 0.1 }",
        "sphere = { radius = 0.1 }, box = { size = [1, 1, 1] }",
        [8, 9],
        "more than one is given",
        "keep one",
    ),
    (
        "density = 0.1",
        "density = \"x\"",
        [4, 11],
        "expected a number",
        "without quotes",
    ),
    (
        "level = 1",
        "level = -1",
        [3, 41],
        "found the number `-1`",
        "of at least 0",
    ),
    (
        "density = 0.1",
        "density = -1",
        [4, 11],
        "-1 kg/m2",
        "above 0",
    ),
    (
        "density = 0.1",
        "density = nan",
        [4, 11],
        "NaN kg/m2",
        "above 0",
    ),
    (
        "radius = 0.1",
        "radius = 0",
        [8, 31],
        "radius` is 0 m",
        "above 0",
    ),
    ("level = 1", "level = 40", [3, 41], "level is 40", ""),
    (
        "vertices = [0]",
        "vertices = [0, 25]",
        [6, 23],
        "no vertex 25",
        "0 to 24",
    ),
    (
        "vertices = [0]",
        "vertices = []",
        [6, 6],
        "no vertex",
        "change the region, or the unit of a mesh file",
    ),
    (
        "version = 1",
        "version = 2",
        [1, 11],
        "version 2",
        "version = 1",
    ),
    ("version = 1", "", [1, 1], "`version` is missing", "add it"),
    (
        "time = 0.1",
        "time = 0.1\n[stop]",
        [12, 2],
        "duplicate key",
        "toml.io",
    ),
    ("time = 0.1", "time = inf", [11, 8], "inf s", "above 0"),
    (
        "square = { side = 0.2, level = 1 }",
        "file = { path = \"no.obj\" }",
        [3, 26],
        "no.obj",
        "relative",
    ),
    (
        "[0, 0, -1]",
        "[0, 0, 0]",
        [7, 1],
        "touches the sheet at vertex",
        "move the obstacle",
    ),
    (
        "[0, 0, -1]",
        "[0, 0]",
        [9, 21],
        "expected a list of length 3, found a list of length 2",
        "in brackets",
    ),
    (
        "vertices = [0] }",
        "vertices = [0] }\nhold = { moving_pin = { x = { ramp = { to = 1, end = -1 } } } }",
        [7, 54],
        "ends at -1 s",
        "",
    ),
    (
        "vertices = [0] }",
        "vertices = [0] }\nhold = { moving_pin = { x = 0.5 } }",
        [7, 8],
        "0.5",
        "zero at the start",
    ),
];

#[test]
fn wrong_scenes_are_told_where_and_what_to_do() {
    parse(RIGHT)
        .unwrap()
        .build()
        .unwrap()
        .start()
        .map(|_| ())
        .unwrap();
    let mut misses = Vec::new();
    for (right, wrong, place, message, remedy) in WRONG {
        assert!(RIGHT.contains(right), "{right}");
        let found = problems(&RIGHT.replacen(right, wrong, 1));
        let about = &found[0];
        let help = about.remedy.as_deref().unwrap_or_default();
        let as_expected = found.len() == 1
            && [about.line, about.column] == place.map(Some)
            && about.message.contains(message)
            && help.contains(remedy);
        if !as_expected {
            misses.push(format!("{wrong}: {found:?}"));
        }
    }
    assert!(misses.is_empty(), "{}", misses.join("\n"));
}

#[test]
fn all_range_errors_are_reported_at_once() {
    let wrong = RIGHT
        .replace("density = 0.1", "density = 0")
        .replace("radius = 0.1", "radius = -3")
        .replace("time = 0.1", "time = 0");
    let keys: Vec<String> = problems(&wrong).into_iter().map(|p| p.key).collect();
    let expected = [
        "sheet.density",
        "obstacle[0].shape.sphere.radius",
        "stop.time",
    ];
    assert_eq!(keys, expected);
}

/// A fan may be as wide as its triangles are, in the unit of the scene.
#[test]
fn fans_that_are_too_wide_are_refused_in_degrees() {
    for (triangles, opening, most) in [(1, 200, 180), (1, 180, 180), (3, 360, 360)] {
        let found = problems(&format!(
            "version = 1
            [sheet]
            mesh = {{ fan = {{ radius = 1, opening = {opening}, triangles = {triangles} }} }}
            [stop]
            time = 0.1"
        ));
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].key, "sheet.mesh.fan.opening");
        let remedy = format!("give more than 0 and less than {most}");
        assert_eq!(found[0].remedy.as_ref(), Some(&remedy));
    }
}

#[test]
fn all_unknown_keys_are_reported_at_once_in_their_order() {
    let wrong = RIGHT
        .replace("density = 0.1", "densty = 0.1")
        .replace("radius = 0.1", "radus = 0.1")
        .replace("[stop]", "[stp]")
        .replace("at = {", "whre = {");
    let found = problems(&wrong);
    let said: Vec<_> = found.iter().map(|p| (p.line, p.key.as_str())).collect();
    let expected = [
        (Some(4), "sheet.densty"),
        (Some(6), "support[0].whre"),
        (Some(8), "obstacle[0].shape.sphere.radus"),
        (Some(10), "stp"),
    ];
    assert_eq!(said, expected);
    let remedies = ["`density`", "`at`", "`radius`", "`stop`"];
    for (problem, right) in found.iter().zip(remedies) {
        let remedy = problem.remedy.as_deref().unwrap();
        assert!(remedy.contains(right), "{problem:?}");
    }
}

/// What is written in another form than the scene has: a table for a list, a list for a table, a number for a
/// vector.
#[test]
fn other_forms_are_told_the_right_one() {
    let gravity = "[forces]\ngravity = 9.81\n";
    let load = "[forces.load]\nat = \"all\"\ndirection = [0, 0, 1]\nsize = 1\n";
    let cases = [
        (
            RIGHT.replace("[[obstacle]]", "[obstacle]"),
            [7, 1],
            "`[[obstacle]]` in double",
        ),
        (
            RIGHT.replace("[[support]]", "[support]"),
            [5, 1],
            "`[[support]]` in double",
        ),
        (
            RIGHT.replace("[stop]", "[[stop]]"),
            [10, 1],
            "below `[stop]`",
        ),
        (
            format!("{RIGHT}{gravity}"),
            [13, 11],
            "`gravity = [0, 0, -9.81]`",
        ),
        (
            format!("{RIGHT}{load}"),
            [12, 1],
            "`[[forces.load]]` in double",
        ),
        (
            RIGHT.replace("[0, 0, -1]", "-1"),
            [9, 21],
            "along x, y and z in brackets",
        ),
        (
            RIGHT.replace("vertices = [0]", "vertices = 0"),
            [6, 19],
            "in brackets",
        ),
    ];
    for (text, place, remedy) in cases {
        let found = problems(&text);
        let [problem] = &found[..] else {
            panic!("{remedy}: {found:?}");
        };
        assert_eq!(
            [problem.line, problem.column],
            place.map(Some),
            "{problem:?}"
        );
        let said = problem.remedy.as_deref().unwrap();
        assert!(said.contains(remedy), "{problem:?}");
    }
}

/// Sizes far beyond any sheet are refused, with the reason.
#[test]
fn absurd_magnitudes_are_refused() {
    let mass = "density = 0.1\nmass = 1e-300";
    for (right, wrong, key, remedy) in [
        (
            "density = 0.1",
            "density = 1e-300",
            "sheet.density",
            "give at least 1e-9, in kg/m2: graphene",
        ),
        (
            "density = 0.1",
            "density = 1e300",
            "sheet.density",
            "give at most 1e9, in kg/m2",
        ),
        ("density = 0.1", mass, "sheet.mass", "in kg:"),
        (
            "radius = 0.1",
            "radius = 1e-200",
            "obstacle[0].shape.sphere.radius",
            "1e-12, in m",
        ),
        (
            "-1] }",
            "-1e200] }",
            "obstacle[0].pose.position[2]",
            "at most -1e12, in m",
        ),
        ("time = 0.1", "time = 1e-100", "stop.time", "1e-15, in s"),
    ] {
        let found = problems(&RIGHT.replace(right, wrong));
        let about: Vec<_> = found.iter().map(|p| p.key.as_str()).collect();
        assert_eq!(about, [key], "{found:?}");
        assert!(
            found[0].remedy.as_deref().unwrap().contains(remedy),
            "{found:?}"
        );
        assert!(found[0].message.contains("out of range"), "{found:?}");
    }
}

/// `--set` of a whole entry is what the scene has, and what is saved of it.
#[test]
fn edits_of_whole_entries_are_made_or_refused() {
    let path = Path::new("test.toml");
    let edited = |edit: &str| SceneFile::parse(RIGHT.into(), path, &[edit.to_owned()]);
    let whole = "obstacle[0]={ shape = \"half_space\", pose = { position = [0, 0, -2] } }";
    let file = edited(whole).unwrap();
    let bodies = &file.scene().obstacle;
    assert_eq!((bodies.len(), bodies[0].pose.position[2]), (1, -2.0));
    assert_eq!(parse(&file.text().text).unwrap().scene(), file.scene());
    let moved = edited("support[0]={ at = { vertices = [24] } }").unwrap();
    assert_eq!(moved.scene().support.len(), 1);
    for refused in ["obstacle[0]={shape=..}", "obstacle[0]=1", "support[0]=[]"] {
        let Err(SceneFileError::Edit(error)) = edited(refused) else {
            panic!("{refused} is accepted");
        };
        assert!(error.to_string().contains(refused), "{error}");
    }
    // A table without its keys is a wrong scene.
    assert!(matches!(
        edited("obstacle[0]={}"),
        Err(SceneFileError::Scene(_))
    ));
}

#[test]
fn methods_that_do_not_fit_and_double_supports_are_refused() {
    let rattle = format!("{RIGHT}[method]\nintegrator = \"rattle\"\n");
    let found = problems(&rattle);
    assert!(found[0].message.contains("contact"), "{found:?}");
    assert_eq!(found[0].line, Some(13));
    let twice = RIGHT.replace(
        "[[obstacle]]",
        "[[support]]\nat = \"all\"\nhold = { moving_pin = {} }\n[[obstacle]]",
    );
    let found = problems(&twice);
    assert_eq!(
        (found[0].line, found[0].key.as_str()),
        (Some(8), "support[1].at")
    );
    assert!(found[0].message.contains("`support[0]`"), "{found:?}");
}

#[test]
fn edits_reach_every_place_and_keep_the_rest() {
    let edits = [
        "stop.time = 0.5",
        "obstacle[0].shape.sphere.radius=0.25",
        "support.0.at.vertices[0]=3",
        "method.integrator=implicit_euler",
        "forces.gravity=[0, 0, -1]",
    ];
    let edits = edits.map(str::to_owned);
    let path = Path::new("test.toml");
    let edited = SceneFile::parse(RIGHT.into(), path, &edits).unwrap();
    let by_hand = RIGHT
        .replace("time = 0.1", "time = 0.5")
        .replace("radius = 0.1", "radius = 0.25")
        .replace("[0] }", "[3] }")
        + "[method]\nintegrator = \"implicit_euler\"\n[forces]\ngravity = [0, 0, -1]\n";
    assert_eq!(edited.scene(), parse(&by_hand).unwrap().scene());
    for wrong in [
        "stop",
        "=3",
        "stop..time=3",
        "obstacle[1].friction=1",
        "stop.time.x=1",
    ] {
        let refused = SceneFile::parse(RIGHT.into(), path, &[wrong.to_owned()]);
        let Err(SceneFileError::Edit(error)) = refused else {
            panic!("{wrong}: {refused:?}");
        };
        assert!(error.to_string().contains(wrong), "{error}");
    }
    assert_eq!(
        Key::root().name("a.b").entry(2).name("c").to_string(),
        "a.b[2].c"
    );
}

#[test]
fn whole_numbers_beyond_those_of_toml_are_refused() {
    let mesh = "rectangle = { width = 1, height = 1, columns = 18446744073709551615, rows = 1 }";
    let seed = "polygon = { outline = [[0, 0], [1, 0], [0, 1]], spacing = 0.5, seed = 9223372036854775808 }";
    for mesh in [mesh, seed] {
        let part = "give at most 9223372036854775807";
        let error = parse(&format!("version = 1\n[sheet]\nmesh = {{ {mesh} }}\n")).unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    }
}

/// The message for an unknown name or choice lists the known ones.
#[test]
fn names_of_bodies_and_choices_are_told() {
    let capsule = "capsule = { radius = 0.1, length = 0 }";
    let body = "name = \"sheet\"\n[[body]]\nname = \"pole\"\nmass = 1\nshape = { sphere = { radius = 0.01 } }\n\
                pose = { position = [0, 0, 3] }\n";
    let with_body = RIGHT.replace("[[support]]", &format!("{body}[[support]]"));
    let measure = "[[measure]]\nname = \"x\"\nsheet = \"pol\"\nat = \"all\"\nquantity = \"x\"\n";
    let pair = "[[contact.pair]]\nsheets = [\"pole\", \"floor\"]\nfriction = 0.1\n";
    let glue = "[[glue]]\nsheets = [\"pole\", \"sheet\"]\nfirst = { vertices = [0] }\n";
    for (text, message, remedy) in [
        (
            RIGHT.replace(
                "at = { vertices = [0] }",
                "at = { vertices = [0] }\nuntil = {}",
            ),
            "one choice among several, and none is given",
            "docs/scene.md has the choices",
        ),
        (
            RIGHT.replace("sphere = { radius = 0.1 }", capsule),
            "has no length: it is a sphere",
            "`sphere = { radius = ... }`",
        ),
        (
            format!("{with_body}{measure}"),
            "no sheet or body has the name `pol`",
            "give one of these: `sheet`, `pole`",
        ),
        (
            format!("{with_body}{pair}"),
            "no sheet, body or obstacle has the name `floor`",
            "give one of these: `sheet`, `pole`",
        ),
        (
            format!("{with_body}{glue}"),
            "the body `pole` stands before the sheet `sheet`",
            "`sheets = [\"sheet\", \"pole\"]`",
        ),
        (
            format!(
                "{RIGHT}[air]\nwind = [6, 0, 0]\n[air.attached]\n\
                 trailing = {{ half_space = {{ point = [1e-6, 0, 0], normal = [-1, 0, 0] }} }}\n"
            ),
            "the air comes from the trailing edge",
            "the edge on the other side",
        ),
    ] {
        let found = problems(&text);
        let is_told = found.iter().any(|problem| {
            let said = problem.remedy.as_deref().unwrap_or_default();
            problem.message.contains(message) && said.contains(remedy)
        });
        assert!(is_told, "{message}: {found:?}");
    }
}

/// Moduli in megapascals and thicknesses in millimetres make sheets that nobody means.
#[test]
fn slips_of_units_of_a_material_are_told() {
    let warnings = |material: &str| -> Vec<String> {
        let text = format!(
            "version = 1\n[sheet]\nmesh = {{ rectangle = {{ width = 0.2, height = 0.1, columns = 2, rows = 1 }} }}\n\
             {material}\n[stop]\ntime = 1"
        );
        let scene = SceneFile::parse(text, Path::new("scene.toml"), &[]).unwrap();
        let warnings = scene.build().unwrap().warnings();
        warnings.iter().map(ToString::to_string).collect()
    };
    for (material, told) in [
        (
            "material = { youngs = 3500, thickness = 5e-4, density = 800 }",
            "`sheet.material.youngs` is 3500 Pa",
        ),
        (
            "material = { youngs = 210000, thickness = 5e-4, density = 7850 }",
            "softer than jelly",
        ),
        (
            "material = { youngs = 3.5e9, thickness = 0.5, density = 800 }",
            "`sheet.material.thickness` is 0.5 m, and the sheet is 0.2 m wide",
        ),
        (
            "material = \"card\"\nthickness = 0.3",
            "`sheet.thickness` is 0.3 m",
        ),
    ] {
        let found = warnings(material);
        assert!(
            found.len() == 1 && found[0].contains(told),
            "{material}: {found:?}"
        );
    }
    let dir = tempfile::tempdir().unwrap();
    let drawing = "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100' fill='none' \
                   stroke='black'><path d='M10 10 H90 V90 H10 Z'/></svg>";
    fs::write(dir.path().join("a.svg"), drawing).unwrap();
    let text = "version = 1\n[sheet]\nmesh = { drawing = { path = \"a.svg\", spacing = 5 } }\n[stop]\ntime = 1";
    let scene = SceneFile::parse(text.into(), &dir.path().join("scene.toml"), &[]).unwrap();
    let found = scene.build().unwrap().warnings();
    let told = "`sheet.mesh.drawing.spacing` is 5 m, and the sheet is 0.08 m wide";
    assert!(
        found.iter().any(|w| w.to_string().contains(told)),
        "{found:?}"
    );
    for material in [
        "material = { youngs = 3.5e9, thickness = 5e-4, density = 800 }",
        // Soft silicone, and foam.
        "material = { youngs = 7e4, thickness = 2e-3, density = 1070 }",
        "material = { youngs = 1e5, thickness = 5e-3, density = 30 }",
    ] {
        assert_eq!(warnings(material), Vec::<String>::new(), "{material}");
    }
}

/// Numbers that are possible, and that no sheet of this world has.
#[test]
fn numbers_that_are_hardly_meant_are_told() {
    let scene = "version = 1\n[sheet]\nmesh = { rectangle = { width = 0.2, height = 0.1, columns = 2, rows = 1 } }\n\
                 material = \"office paper\"\n[[crease]]\nat = { line = { from = [0.1, 0, 0], to = [0.1, 0.1, 0] } }\n\
                 stiffness = 0.1\nangle = 30\n[forces]\ngravity = [0, 0, -9.81]\n[stop]\ntime = 1";
    let warnings = |edits: &[&str]| -> Vec<String> {
        let edits: Vec<String> = edits.iter().map(|edit| (*edit).to_owned()).collect();
        let scene = SceneFile::parse(scene.into(), Path::new("scene.toml"), &edits).unwrap();
        let warnings = scene.build().unwrap().warnings();
        warnings.iter().map(ToString::to_string).collect()
    };
    assert_eq!(warnings(&[]), Vec::<String>::new());
    for (edit, told) in [
        (
            "forces.gravity=[0,0,-9810]",
            "`forces.gravity[2]` is -9810 m/s2",
        ),
        ("forces.gravity=[0,0,-981]", "9.81 m/s2"),
        ("sheet.density=80", "`sheet.density` is 80 kg/m2"),
        (
            "sheet.start.velocity=[0,0,500]",
            "`sheet.start.velocity[2]` is 500 m/s",
        ),
        ("crease.0.angle=0.8", "in radians that is 45.8 degrees"),
        ("crease.0.angle=3.1416", "in radians that is 180 degrees"),
        (
            "crease.0.angle={smooth_step={to=-3.14,end=1}}",
            "in radians that is 180 degrees",
        ),
        (
            "crease.0={at={line={from=[0.1,0,0],to=[0.1,0.1,0]}},stiffness=0.1,yield={moment=0.01},angle={ramp={to=90,end=1}}}",
            "a crease that folds by its own angle, `crease[0].angle`, has hardly any",
        ),
        (
            "sheet.isometry.elastic={stiffness=3e9}",
            "`sheet.isometry.elastic.stiffness` is 3e9 N/m",
        ),
    ] {
        let found = warnings(&[edit]);
        assert!(
            found.len() == 1 && found[0].contains(told),
            "{edit}: {found:?}"
        );
    }
}

/// A mesh or a drawing in the place of a scene is told the key that takes it; an open outline the key that
/// closes it; a face that is too narrow for contact where it is.
#[test]
fn remedies_are_those_of_scenes() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.svg");
    let open = "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100' fill='none' \
                stroke='black'><path d='M10 10 H90 V90 H10 V12'/></svg>";
    fs::write(&path, open).unwrap();
    let error = SceneFile::read(&path, &[]).unwrap_err();
    assert!(
        error.to_string().contains("it is a drawing and no scene"),
        "{error}"
    );
    assert!(
        error
            .advice()
            .unwrap_or_default()
            .contains("mesh = { drawing ="),
        "{error}"
    );
    let scene = "version = 1\n[sheet]\nmesh = { drawing = { path = \"a.svg\", spacing = 0.02 } }";
    let scene = SceneFile::parse(scene.into(), &dir.path().join("scene.toml"), &[]).unwrap();
    let told = scene.build().unwrap_err().to_string();
    assert!(told.contains("give a `snap` of at least the gap"), "{told}");
    let scene = "version = 1\n[sheet]\nmesh = { rectangle = { width = 0.2, height = 0.1, columns = 2, rows = 100 } }\n\
                 material = \"office paper\"\nthickness = 0.01\n[contact]\nself_contact = true";
    let scene = SceneFile::parse(scene.into(), Path::new("scene.toml"), &[]).unwrap();
    let told = scene.build().unwrap_err().to_string();
    assert!(told.contains("the face is at (0."), "{told}");
}

/// Problems of the entries of one list tend to have one cause: the first are shown, and how many there are
/// besides.
#[test]
fn problems_of_a_list_are_shown_up_to_a_few() {
    let rows = vec!["[nan, 0, 0]"; 25].join(", ");
    let text = format!(
        "version = 1\n[sheet]\nmesh = {{ square = {{ side = 0.2, level = 1 }} }}\nstart = {{ positions = [{rows}] }}\n\
         [stop]\ntime = -1\n"
    );
    let error = parse(&text).map(drop).unwrap_err().to_string();
    assert_eq!(error.matches("has the component").count(), 3, "{error}");
    assert!(
        error.contains("`sheet.start.positions` has 22 more such problems"),
        "{error}"
    );
    assert!(error.contains("`stop.time` is -1"), "{error}");
}
