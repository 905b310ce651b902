//! What is taken up and released: what is refused, and what it does.

use crate::bodies::problem;
use crate::parse;
use isosheet_formats::{EventChange, EventKind};
use isosheet_scenes::{LiveScene, Scene};

const SQUARE: &str = r#"
    version = 1
    [sheet]
    mesh = { square = { side = 0.2, level = 1 } }
    [[measure]]
    name = "height"
    at = { vertices = [0] }
    quantity = "z"
    [method]
    step = 0.01
"#;

fn live(text: &str) -> LiveScene {
    let file = parse(text).unwrap_or_else(|e| panic!("{e}"));
    LiveScene::start(file).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn periods_without_sense_are_refused() {
    for (text, cause) in [
        (
            "[[support]]\nat = \"all\"\nuntil = 0",
            "not a positive number",
        ),
        (
            "[[support]]\nat = \"all\"\nfrom = 0.5\nuntil = 0.5",
            "released at 0.5 s, before it is taken up at 0.5 s",
        ),
        (
            "[[support]]\nat = \"all\"\nuntil = { measure = { name = \"width\", above = 1 } }",
            "no measure `width`",
        ),
        (
            "[[support]]\nat = \"all\"\nuntil = { measure = { name = \"height\" } }",
            "the threshold is missing",
        ),
        (
            "[[support]]\nat = \"all\"\nuntil = { measure = { name = \"height\", above = 1, below = 0 } }",
            "both `above` and `below`",
        ),
        (
            "[[support]]\nat = \"all\"\nuntil = { force = -1 }",
            "not a positive number",
        ),
        (
            "[[support]]\nat = \"all\"\nfrom = { force = 1 }",
            "carries no force",
        ),
        (
            "[[glue]]\nfirst = { vertices = [0] }\nsecond = { vertices = [4] }\nfrom = 1\nclosing = 0",
            "as far apart as they are then",
        ),
        (
            "[contact]\nself_contact = true\n[[contact.pair]]\nsheets = [\"sheet\", \"sheet\"]\nfriction = 0\nuntil = { force = 1 }",
            "not released by its force",
        ),
    ] {
        let error = parse(&format!("{SQUARE}{text}"))
            .expect_err(text)
            .to_string();
        assert!(error.contains(cause), "{text}: {error}");
    }
    let text = SQUARE.replace(
        "step = 0.01",
        "step = 0.01\nintegrator = \"energy_momentum\"",
    );
    let text = format!("{text}[[support]]\nat = \"all\"\nuntil = 1");
    let error = parse(&text)
        .expect_err("a method without minima")
        .to_string();
    assert!(error.contains("what comes and goes"), "{error}");
}

/// A square that falls freely is caught after 0.1 s and lifted by 10 mm from where it is then.
#[test]
fn what_is_taken_up_holds_vertices_where_they_are_and_moves_from_there() {
    let mut scene = live(&format!(
        "{SQUARE}[[support]]\nat = \"all\"\nfrom = 0.1
        hold = {{ moving_pin = {{ z = {{ ramp = {{ to = 0.02, end = 0.2 }} }} }} }}
        [forces]\ngravity = [0, 0, -9.81]"
    ));
    for _ in 0..10 {
        scene.step(0.01).expect("accepted");
    }
    let event = scene.events()[0];
    assert_eq!(
        (event.on, event.change),
        (EventKind::Support, EventChange::TakenUp)
    );
    let z = scene.positions()[2];
    // Free fall; BDF2 errs by its first step.
    assert!((z + 0.5 * 9.81 * 0.01).abs() < 2e-3, "{z}");
    for _ in 0..10 {
        scene.step(0.01).expect("accepted");
    }
    // Half of the ramp has passed when it is taken up.
    let lifted = scene.positions()[2] - z;
    assert!((lifted - 0.01).abs() < 1e-12, "{lifted}");
    let checkpoint = scene.simulation().checkpoint();
    let mut resumed = LiveScene::resume(scene.file().clone(), checkpoint).expect("the same scene");
    assert_eq!(
        resumed.step(0.01).expect("accepted"),
        scene.step(0.01).expect("accepted")
    );
    assert_eq!(resumed.positions(), scene.positions());
}

/// A square that rises lets go at a height, and a support that has to carry too much.
#[test]
fn supports_are_released_by_a_measure_and_by_their_force() {
    let text = format!(
        "{SQUARE}[[support]]\nat = \"all\"
        hold = {{ moving_pin = {{ z = {{ ramp = {{ to = 0.1, end = 1 }} }} }} }}
        until = {{ measure = {{ name = \"height\", above = 0.0205 }} }}"
    );
    let mut scene = live(&text);
    let mut steps = 0;
    while scene.events().is_empty() {
        scene.step(0.01).expect("accepted");
        steps += 1;
    }
    assert_eq!(steps, 21);
    // It flies on with the velocity of the support.
    scene.step(0.01).expect("accepted");
    assert!((scene.velocities()[2] - 0.1).abs() < 1e-12);

    // Gravity grows until the whole weight is 0.01 N.
    let weight = format!(
        "{SQUARE}[[support]]\nat = \"all\"\nuntil = {{ force = 0.01 }}
        [[forces.acceleration]]\ndirection = [0, 0, -1]\nsize = {{ ramp = {{ to = 10, end = 1 }} }}"
    );
    let mut scene = live(&weight);
    while scene.events().is_empty() {
        scene.step(0.01).expect("accepted");
    }
    let mass = scene.simulation().model().mass().total();
    let event = scene.events()[0];
    // In a step acts the acceleration at its end.
    let force = event.force.expect("of a support");
    let expected = mass * 10.0 * event.t;
    assert!((force - expected).abs() < 1e-9, "{force}, {expected}");
    assert!(
        (0.01..0.01 + mass * 10.0 * 0.01).contains(&force),
        "{event:?}"
    );
    assert!((scene.support_forces()[0][2] - force).abs() < 1e-15);
    scene.step(0.01).expect("accepted");
    assert_eq!(scene.support_forces(), [[0.0; 3]]);
}

/// A checkpoint of one phase is not that of another one.
#[test]
fn a_checkpoint_after_a_release_is_not_taken_for_one_before() {
    let mut scene = live(&format!(
        "{SQUARE}[[glue]]\nfirst = {{ vertices = [0] }}\nsecond = {{ vertices = [4] }}\nclosing = 0.0\nuntil = 0.01"
    ));
    scene.step(0.01).expect("accepted");
    assert_eq!(scene.events()[0].change, EventChange::Released);
    let checkpoint = scene.simulation().checkpoint();
    let before = scene
        .file()
        .build()
        .expect("a scene")
        .resume(checkpoint.clone());
    let error = before.map(drop).expect_err("another phase").to_string();
    assert!(
        error.contains("other supports, seams or contacts hold"),
        "{error}"
    );
    let setup = scene.file().build_at(&checkpoint).expect("the scene then");
    assert!(setup.resume(checkpoint.clone()).is_ok());
    let other: Scene = parse(SQUARE).expect("a scene").scene().clone();
    let other = isosheet_scenes::SceneFile::of(other, std::path::Path::new("")).expect("a file");
    assert!(other.build_at(&checkpoint).is_err());
}

/// Two squares pass through each other, and then they do not; they have to be apart at that moment.
#[test]
fn contact_begins_and_ends() {
    let squares = |gap: f64, period: &str| {
        format!(
            "version = 1
            [[sheet]]\nname = \"low\"\nmesh = {{ square = {{ side = 0.2, level = 1 }} }}
            [[sheet]]\nname = \"high\"\nmesh = {{ square = {{ side = 0.2, level = 1 }} }}
            placement = {{ position = [0.01, 0.013, {gap}] }}
            start = {{ velocity = [0, 0, -0.1] }}
            [[support]]\nsheet = \"low\"\nat = \"all\"
            [contact]\nself_contact = true
            [[contact.pair]]\nsheets = [\"low\", \"high\"]\nfriction = 0\n{period}
            [method]\nstep = 0.01"
        )
    };
    let height = |scene: &LiveScene| scene.positions()[scene.positions().len() - 1];
    let after = |text: &str| {
        let mut scene = live(text);
        for _ in 0..20 {
            scene.step(0.01)?;
        }
        Ok::<f64, isosheet_scenes::FailedStep>(height(&scene))
    };
    // At 0.1 m/s it comes down by 20 mm, unless the other one is in the way.
    assert!(after(&squares(0.01, "")).expect("accepted") > 0.0);
    let passed = after(&squares(0.01, "from = 0.15")).expect("accepted");
    assert!((passed + 0.01).abs() < 1e-9, "{passed}");
    assert!(after(&squares(0.01, "from = 0.05")).expect("accepted") > 0.0);
    let released = after(&squares(0.01, "until = 0.005")).expect("accepted");
    assert!((released + 0.01).abs() < 1e-9, "{released}");
    // Of one that is inclined a part is below the other one at 0.1 s.
    let inclined = squares(0.001, "from = 0.1").replace(
        "0.001] }",
        "0.001], turn = { axis = [1, 0, 0], angle = 10 } }",
    );
    let error = after(&inclined).expect_err("they intersect");
    let text = error.to_string();
    assert!(
        text.contains("contact.pair[0]") && text.contains("cannot be taken up at 0.1 s"),
        "{text}"
    );
    assert!(text.contains("let them be apart"), "{text}");
}

/// A strip that two clamps hold in turn, elastic and yielding: the second one holds place and slope where
/// they are.
#[test]
fn a_clamp_is_taken_up_where_the_sheet_is_and_the_other_one_released() {
    for yields in ["", "yield = { moment = 1e-3 }"] {
        let mut scene = live(&format!(
            "version = 1
            [sheet]
            mesh = {{ rectangle = {{ width = 0.1, height = 0.02, columns = 10, rows = 2 }} }}
            material = \"PET film\"\ndamping = 2.0\n{yields}
            [[support]]\nat = {{ vertices = [0, 11, 22] }}\nhold = \"clamp\"\nuntil = 0.2
            [[support]]\nat = {{ vertices = [10, 21, 32] }}\nhold = \"clamp\"\nfrom = 0.1
            [forces]\ngravity = [0, 0, -9.81]
            [method]\nstep = 0.01"
        ));
        let tip = |scene: &LiveScene| scene.positions()[3 * 10..3 * 11].to_vec();
        for _ in 0..10 {
            scene.step(0.01).expect("accepted");
        }
        assert_eq!(scene.events()[0].change, EventChange::TakenUp);
        let caught = tip(&scene);
        assert!(caught[2] < -0.005, "{caught:?}");
        for _ in 0..10 {
            scene.step(0.01).expect("accepted");
            assert_eq!(tip(&scene), caught);
        }
        assert_eq!(scene.events()[0].change, EventChange::Released);
        for _ in 0..10 {
            scene.step(0.01).expect("accepted");
            assert_eq!(tip(&scene), caught);
        }
        // The end that was let go hangs, and the other clamp carries it all.
        assert!(scene.positions()[2] < -0.001);
        let checkpoint = scene.simulation().checkpoint();
        let mut resumed = LiveScene::resume(scene.file().clone(), checkpoint).expect("the same");
        let reports = [resumed.step(0.01), scene.step(0.01)].map(|r| r.expect("accepted"));
        assert_eq!(reports[0], reports[1]);
    }
}

/// What switches in time and has no place for it is refused before the run.
#[test]
fn what_cannot_come_and_go_is_said_at_the_start() {
    let two = "version = 1
        [[sheet]]
        name = \"a\"
        mesh = { square = { side = 0.1, level = 1 } }
        material = \"PET film\"
        [[sheet]]
        name = \"b\"
        mesh = { square = { side = 0.1, level = 1 } }
        material = \"PET film\"
        placement = { position = [0, 0, 0.01] }
        [[obstacle]]
        name = \"floor\"
        shape = \"half_space\"
        pose = { position = [0, 0, -0.1] }
        [contact]
        self_contact = true\n";
    let pair = |names: [&str; 2], more: &str| {
        format!("[[contact.pair]]\nsheets = {names:?}\nfriction = 0.2\n{more}\n")
    };
    let seam = "[[glue]]\nsheets = [\"a\", \"b\"]\nfirst = { vertices = [0, 1] }\nsecond = { vertices = [0, 1] }\n\
                closing = 0\n";
    for (wrong, part) in [
        (
            pair(["a", "floor"], "until = 0.2"),
            "an obstacle that does not deform",
        ),
        (
            pair(["a", "b"], "until = 0.1") + &pair(["b", "a"], "from = 0.2"),
            "`contact.pair[0]` is of the same two",
        ),
        (
            format!("{seam}until = 0.2\n[[forces.gas]]\n"),
            "a seam of the sheets around it",
        ),
        (
            format!(
                "{}until = 0.2\nbend = {{ stiffness = 1 }}\n",
                seam.replace("closing = 0\n", "")
            ),
            "closed at all times",
        ),
    ] {
        let said = problem(&format!("{two}{wrong}"));
        assert!(said.contains(part), "{wrong}: {said}");
    }
}

/// Where nothing is free at the start, the barrier is as stiff as without weight, and the sheet lands when it
/// is let go.
#[test]
fn a_sheet_that_is_held_whole_may_fall_later() {
    let mut live = live(&format!(
        "{SQUARE}
        [[support]]
        at = \"all\"
        until = 0.05
        [[obstacle]]
        shape = \"half_space\"
        pose = {{ position = [0, 0, -0.02] }}
        [contact]
        self_contact = true
        [forces]
        gravity = [0, 0, -9.81]
        [stop]
        time = 0.3"
    ));
    for _ in 0..30 {
        live.step(0.01).unwrap();
    }
    let heights = live.positions();
    let lowest = heights
        .iter()
        .skip(2)
        .step_by(3)
        .fold(f64::INFINITY, |m, z| m.min(*z));
    assert!((-0.02..-0.018).contains(&lowest), "{lowest}");
}
