//! The hands of a model.

use crate::SheetModel;
use crate::sheet_model::hand::{Hand, HandError};
use isosheet_mesh::VertexId;

impl SheetModel {
    /// Adds a hand.
    #[must_use]
    pub fn with_hand(mut self, hand: Hand) -> Self {
        self.hands.push((self.potentials.len(), hand.clone()));
        self.with_potential(hand)
    }

    /// The hand that holds a vertex, with the number of its potential.
    pub fn hand(&self, vertex: VertexId) -> Result<(usize, &Hand), HandError> {
        let hand = self.hands.iter().find(|(_, hand)| hand.vertex() == vertex);
        let (number, hand) = hand.ok_or(HandError::NoHand { vertex })?;
        Ok((*number, hand))
    }
}
