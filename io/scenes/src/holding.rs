//! What holds and touches: supports, seams and contact, and when they do.

pub(crate) mod bond;
pub(crate) mod contact;
pub(crate) mod glue;
pub(crate) mod supports;
pub(crate) mod switch;
