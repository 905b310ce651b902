//! Gradients beside central differences, closed forms and searches.

mod differences;
mod support;
