//! The page of a run that is played, used by its pointer and its keys in a browser without a window.
//!
//! The test runs where Chromium or Chrome is installed, and says so where it is not. `ISOSHEET_PICTURES`
//! names a folder for pictures of what it sees.

use crate::devtools::{Driven, Pointer};
use crate::live::{Served, time, vertex};
use crate::with_scene;
use isosheet_scenes::StartingPoint;
use serde_json::{Value, json};

/// Keeps a picture for a look.
fn show(page: &mut Driven, name: &str) {
    if let Some(folder) = std::env::var_os("ISOSHEET_PICTURES") {
        let file = std::path::Path::new(&folder).join(name);
        std::fs::write(file, page.picture()).unwrap();
    }
}

fn text(page: &mut Driven, id: &str) -> String {
    let value = page.value(&format!("document.getElementById('{id}').textContent"));
    value.as_str().unwrap().to_owned()
}

/// The box of the 3D view: its left upper corner, width and height, in pixels.
fn view(page: &mut Driven) -> [f64; 4] {
    let place = page.value(
        "(() => { const b = document.getElementById('view').getBoundingClientRect(); \
         return [b.x, b.y, b.width, b.height]; })()",
    );
    [0, 1, 2, 3].map(|k| place[k].as_f64().unwrap())
}

/// Looks with the pointer for a vertex that can be held. Where it is, in pixels.
fn find(page: &mut Driven, vertex: usize) -> [f64; 2] {
    let [left, top, width, height] = view(page);
    // Moves without the browser's own handling, of which a thousand take a minute.
    let look = format!(
        "(() => {{ const view = document.getElementById('view'), hover = document.getElementById('hover'); \
         for (let y = {top}; y < {bottom}; y += 6) for (let x = {left}; x < {right}; x += 6) {{ \
         view.dispatchEvent(new PointerEvent('pointermove', {{ clientX: x, clientY: y, bubbles: true }})); \
         if (view.dataset.hand === 'offers' && hover.textContent.startsWith('Vertex {vertex} at')) return [x, y]; \
         }} return null; }})()",
        bottom = top + height,
        right = left + width,
    );
    let place = page.value(&look);
    let place = [0, 1].map(|k| place[k].as_f64().expect("the vertex is seen"));
    page.pointer(Pointer::Move, place);
    let offers = "document.getElementById('view').dataset.hand === 'offers'";
    assert_eq!(page.value(offers), json!(true));
    place
}

const PLAYS: &str = "document.getElementById('play').getAttribute('aria-label') === 'Pause'";

#[test]
fn a_corner_that_the_mouse_drags_follows_it() {
    let folder = with_scene(StartingPoint::Hanging);
    let served = Served::start(folder.path(), &["--set", "stop.time=1000"]);
    let Some(mut page) = Driven::visit(&served.address) else {
        return;
    };
    // A page that is loaded again steers again, from farther away.
    page.go("#camera=0.45,-0.55,0.25,0.1,0.1,-0.08");
    page.wait_for("document.getElementById('pace').textContent === 'paused'");
    page.wait_for("!document.getElementById('play').disabled");
    show(&mut page, "live-start.png");
    let mut witness = served.watch();
    let begin = witness.frame(|_| true);

    // A step by the button, and one by the key.
    page.click("step");
    let one = witness.frame(|f| time(f) > 0.0);
    page.press("ArrowRight");
    let two = witness.frame(|f| time(f) > time(&one));
    assert!((time(&two) - 2.0 * time(&one)).abs() < 1e-12);

    let corner = 0;
    let place = find(&mut page, corner);
    page.pointer(Pointer::Press, place);
    let from = vertex(&begin, corner);
    witness.frame(|f| f["hand"]["vertex"] == corner);
    page.press(" ");
    page.wait_for(PLAYS);
    let [dx, dy] = [60.0, -150.0];
    for part in 1..=20 {
        let part = f64::from(part) / 20.0;
        page.pointer(Pointer::Drag, [place[0] + part * dx, place[1] + part * dy]);
    }
    let aim = |frame: &Value| [0, 1, 2].map(|k| frame["hand"]["to"][k].as_f64().unwrap());
    // The camera looks from above: the corner is led upwards.
    witness.frame(|f| aim(f)[2] > from[2] + 0.03);
    witness.frame(|f| vertex(f, corner)[2] > from[2] + 0.02);
    page.wait_for("document.getElementById('pace').textContent.endsWith('real time')");
    show(&mut page, "live-drag.png");
    page.pointer(Pointer::Release, [place[0] + dx, place[1] + dy]);
    witness.frame(|f| f["hand"].is_null());
    witness.frame(|f| vertex(f, corner)[2] < from[2]);

    // A second browser watches.
    let mut second = Driven::visit(&served.address).expect("there was one");
    let role = "document.getElementById('role').textContent";
    second.wait_for(&format!("{role} === 'Another page steers'"));
    second.wait_for(PLAYS);
    assert_eq!(
        second.value("document.getElementById('play').disabled"),
        json!(true)
    );
    let before = text(&mut second, "time");
    second.wait_for(&format!(
        "document.getElementById('time').textContent !== '{before}'"
    ));
    second.press(" ");
    page.wait_for(&format!("{role} === '2 other pages watch'"));
    assert_eq!(page.value(PLAYS), json!(true), "who watches cannot pause");
    show(&mut second, "live-watch.png");
    page.press(" ");
    page.wait_for(&format!("!({PLAYS})"));
    second.wait_for(&format!("!({PLAYS})"));

    // Beside the sheet the pointer turns the camera, and holds nothing.
    let [left, top, _, _] = view(&mut page);
    let camera = page.value("location.hash");
    page.pointer(Pointer::Press, [left + 12.0, top + 12.0]);
    page.pointer(Pointer::Drag, [left + 90.0, top + 40.0]);
    page.pointer(Pointer::Release, [left + 90.0, top + 40.0]);
    page.wait_for(&format!("location.hash !== {camera}"));

    page.click("end");
    let ended = "document.getElementById('notice').textContent === 'The run has ended.'";
    page.wait_for(ended);
    second.wait_for(ended);
}

#[test]
fn sliders_are_moved_in_the_page() {
    let folder = with_scene(StartingPoint::Flag);
    let served = Served::start(folder.path(), &["--set", "stop.time=1000"]);
    let Some(mut page) = Driven::visit(&served.address) else {
        return;
    };
    page.wait_for("document.getElementById('slider-0')?.disabled === false");
    let mut witness = served.watch();
    let begin = witness.frame(|_| true);
    page.press(" ");
    let slider = |frame: &Value| frame["sliders"][0].as_f64();
    page.drag("slider-0", [25.0, 0.0]);
    let value = page.value("Number(document.getElementById('slider-0').value)");
    assert_ne!(value.as_f64(), slider(&begin));
    witness.frame(|f| slider(f) == value.as_f64());
    show(&mut page, "live-flag.png");
}
