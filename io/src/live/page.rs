//! The page of a run that goes on, at its start.

use super::session::Session;
use isosheet_files::DataError;
use isosheet_mesh::VertexId;
use isosheet_page::{Body, LivePage, Replay};

/// The page of a session: that of a run with one frame, and what it is steered by.
///
/// # Errors
/// [`DataError`] if the scene cannot be shown.
pub(super) fn page(session: &Session, title: &str, nonce: &str) -> Result<String, DataError> {
    let live = session.live();
    let (simulation, scene) = (live.simulation(), live.file().scene());
    let state = simulation.state();
    let times = [state.t];
    let obstacles = live.facts().obstacles.iter().enumerate();
    let obstacles = obstacles.map(|(k, body)| {
        let name = live.facts().origins.obstacle_called(k);
        Body::of_obstacle(&name, body, &times)
    });
    let holding = session.holding().iter().map(|body| {
        let pose = |t: f64| body.pose(scene, t);
        Body::moving(&body.name, body.shape.clone(), &times, pose)
    });
    let numbers = |vertices: &[VertexId]| vertices.iter().map(|v| v.0).collect();
    let file = live.file().text().path.display();
    let replay = Replay {
        title: title.into(),
        sheets: live
            .facts()
            .parts
            .iter()
            .map(|(_, part)| part.faces.len())
            .collect(),
        faces: live.facts().sheet.face_indices(),
        rest: live.facts().sheet.positions().to_vec(),
        times: times.to_vec(),
        positions: vec![live.positions().into_owned()],
        pins: numbers(&live.pins()),
        immobile: numbers(simulation.immobile_vertices()),
        bodies: obstacles.chain(holding).collect(),
        series: session.plotted(),
        summary: vec![("modelled".into(), live.facts().modelled.join(", "))],
        scene: live.file().text().text.clone(),
        reproduce: format!("isosheet live {file}"),
        ..Replay::default()
    };
    let sliders = session.sliders().iter().map(|slider| slider.shown.clone());
    replay.to_live_html(&LivePage {
        sliders: sliders.collect(),
        nonce: nonce.into(),
    })
}
