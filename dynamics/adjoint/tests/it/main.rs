//! Gradients beside central differences, closed forms and searches.

mod contact;
mod differences;
mod support;
