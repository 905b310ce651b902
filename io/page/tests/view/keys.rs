//! The page used by its pointer and its keys, in a browser without a window.
//!
//! These tests run where Chromium or Chrome is installed, and say so where it is not.

use super::scenes::waving;
use crate::devtools::Driven;
use serde_json::json;

const FRAME: &str = "Number(document.getElementById('scrub').value)";
const PLAYS: &str = "document.getElementById('play').getAttribute('aria-label') === 'Pause'";

/// Whether space plays and stops, and the arrows step.
fn assert_keys_work(page: &mut Driven, after: &str) {
    page.press("Home");
    assert_eq!(page.value(FRAME), json!(0), "Home after {after}");
    page.press("ArrowRight");
    page.press("ArrowRight");
    page.press("ArrowLeft");
    assert_eq!(page.value(FRAME), json!(1), "arrows after {after}");
    page.press(" ");
    assert_eq!(page.value(PLAYS), json!(true), "space plays after {after}");
    page.press(" ");
    assert_eq!(page.value(PLAYS), json!(false), "space stops after {after}");
}

#[test]
fn space_and_arrows_work_after_any_control_was_used() {
    let Some(mut page) = Driven::open(&waving(2, 600).to_html().unwrap()) else {
        return;
    };
    assert_keys_work(&mut page, "nothing");
    for box_ in ["edges", "wireframe", "rest"] {
        let state = format!("document.getElementById('{box_}').checked");
        let before = page.value(&state);
        page.click(box_);
        assert_ne!(page.value(&state), before, "{box_} is clicked");
        assert_keys_work(&mut page, box_);
        assert_ne!(page.value(&state), before, "space leaves {box_} as it is");
    }
    for button in ["fit", "reset"] {
        page.click(button);
        assert_keys_work(&mut page, button);
    }
    page.click("play");
    assert_eq!(page.value(PLAYS), json!(true));
    page.click("play");
    assert_keys_work(&mut page, "play");
    page.click("scrub");
    let middle = page.value(FRAME).as_f64().unwrap();
    assert!((middle - 300.0).abs() < 30.0, "{middle}");
    assert_keys_work(&mut page, "scrub");
    // A choice that was opened by the pointer and made by keys, as in the list that opens.
    for list in ["speed", "colour"] {
        let choice = format!("document.getElementById('{list}').selectedIndex");
        let before = page.value(&choice);
        page.click(list);
        page.press("ArrowDown");
        page.press("Enter");
        assert_ne!(page.value(&choice), before, "{list} is chosen");
        assert_keys_work(&mut page, list);
        assert_ne!(page.value(&choice), before, "arrows leave {list} as it is");
    }
}

/// Space plays from the first moment on, from the start of a motion that the page opens in the midst of.
#[test]
fn space_plays_before_anything_was_clicked() {
    let Some(mut page) = Driven::open(&waving(2, 600).to_html().unwrap()) else {
        return;
    };
    let opened = page.value(FRAME).as_f64().unwrap();
    assert!(opened > 0.0, "nothing has moved in the first frame");
    page.press(" ");
    assert_eq!(page.value(PLAYS), json!(true));
    page.wait_for(&format!("{FRAME} < {opened}"));
    page.press(" ");
    assert_eq!(page.value(PLAYS), json!(false));
}

/// Controls that are reached by the tabulator are used by Enter, for people without a pointer, and space
/// plays.
#[test]
fn space_plays_wherever_the_focus_is() {
    let Some(mut page) = Driven::open(&waving(2, 12).to_html().unwrap()) else {
        return;
    };
    page.value("document.getElementById('colour').focus()");
    page.press("Tab");
    let focused = "document.activeElement.id";
    assert_eq!(page.value(focused), json!("edges"));
    let edges = "document.getElementById('edges').checked";
    page.press("Enter");
    assert_eq!(page.value(edges), json!(false));
    assert_eq!(page.value(focused), json!("edges"));
    page.press("Home");
    page.press("ArrowRight");
    assert_eq!(page.value(FRAME), json!(1), "a box has no use for arrows");
    for control in ["edges", "colour", "fit", "speed", "view", "scrub"] {
        page.value(&format!("document.getElementById('{control}').focus()"));
        page.press(" ");
        assert_eq!(page.value(PLAYS), json!(true), "space plays at {control}");
        page.press(" ");
        assert_eq!(page.value(PLAYS), json!(false), "space stops at {control}");
    }
    assert_eq!(page.value(edges), json!(false), "space leaves boxes alone");
}

#[test]
fn the_address_says_what_is_shown_and_shows_it_again() {
    let Some(mut page) = Driven::open(&waving(2, 12).to_html().unwrap()) else {
        return;
    };
    let colour = "document.getElementById('colour').value";
    assert_eq!(page.value("location.hash"), json!(""));
    let opened = page.value(FRAME);
    page.press("Home");
    page.press("ArrowRight");
    page.press("ArrowRight");
    page.wait_for("location.hash === '#frame=2'");
    page.click("colour");
    page.press("ArrowDown");
    page.press("Enter");
    let chosen = page.value(colour);
    page.drag("view", [90.0, 40.0]);
    let all = "/^#frame=2&colour=[a-z0-9-]+&camera=(-?[0-9.]+,){5}-?[0-9.]+$/.test(location.hash)";
    page.wait_for(all);
    let hash = page.value("location.hash");
    let hash = hash.as_str().expect("a fragment").to_owned();
    // The same address, in a page that is loaded anew, shows the same, and says the same after a change.
    page.go(&hash);
    assert_eq!(page.value(FRAME), json!(2));
    assert_eq!(page.value(colour), chosen);
    page.press("ArrowRight");
    let next = hash.replace("frame=2", "frame=3");
    page.wait_for(&format!("location.hash === '{next}'"));
    // An address that is typed into an open page is followed, and what it leaves out is as at the start.
    page.value("location.hash = '#frame=5'");
    page.wait_for(&format!("{FRAME} === 5"));
    assert_ne!(page.value(colour), chosen);
    page.press("ArrowRight");
    page.wait_for("location.hash === '#frame=6'");
    // Nonsense is no reason to show nothing.
    page.go("#frame=many&colour=none&camera=1,2,x&bodies=no");
    assert_eq!(page.value(FRAME), opened);
}
