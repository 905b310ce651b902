//! A scene made in a program: a sheet that hangs by one corner, run in the folder that the first argument
//! names.

use isosheet_runs::simulate;
use isosheet_scenes::{Mesh, Scene, SceneFile, Selection, SheetKey, SupportKey};
use std::ops::ControlFlow;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args()
        .nth(1)
        .map_or("hanging-run".into(), PathBuf::from);
    let mut scene = Scene::new(SheetKey::new(Mesh::Square {
        side: 0.2,
        level: 2,
    }));
    scene
        .support
        .push(SupportKey::pin(Selection::Nearest(vec![[0.0, 0.2, 0.0]])));
    scene.forces.gravity = Some([0.0, 0.0, -9.81]);
    scene.stop.time = 0.5;
    let file = SceneFile::of(scene, &folder)?;
    let outcome = simulate(&file, &folder, &mut |_: &_| ControlFlow::Continue(()))?;
    println!("{outcome:#?}");
    Ok(())
}
