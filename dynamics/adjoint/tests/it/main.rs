//! Gradients beside central differences, closed forms and searches.

mod closed_forms;
mod contact;
mod differences;
mod forces;
mod inverse;
mod refusals;
mod search;
mod support;
