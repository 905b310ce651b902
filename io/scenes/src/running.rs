//! Simulations of scenes that go on, and change.

pub(crate) mod courses;
pub(crate) mod driven_into;
pub(crate) mod jump;
pub(crate) mod live;
pub(crate) mod too_fast;
pub(crate) mod under_way;
