//! Gradients beside central differences, closed forms and searches.

mod closed_forms;
mod contact;
mod differences;
mod forces;
mod inverse;
mod problems;
mod refusals;
mod search;
mod support;
