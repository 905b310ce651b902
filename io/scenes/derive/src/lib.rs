//! The derive macro of the trait `Part` of `isosheet-scenes`.

use proc_macro2::{Span, TokenStream};
use quote::{ToTokens, format_ident, quote};
use syn::punctuated::Punctuated;
use syn::{
    Attribute, Data, DeriveInput, Error, Expr, ExprLit, Field, Fields, Ident, Lit, Meta, Result,
    Token, Variant, parse_macro_input,
};

/// Makes a struct or an enum a part of a scene: its fields are its parts, at the keys at which `serde` reads
/// them. A function of time says what it is in, `#[unit(Metre)]`. What is `#[checked]` checks its own numbers
/// by a function `check(&self, key: &Key, checks: &mut Checks)`.
#[proc_macro_derive(Part, attributes(checked, serde, unit))]
pub fn derive_part(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    part(&input).unwrap_or_else(|e| e.to_compile_error()).into()
}

fn part(input: &DeriveInput) -> Result<TokenStream> {
    let name = &input.ident;
    let walk = |module: Ident| -> Result<TokenStream> {
        let arms = match &input.data {
            Data::Struct(of) => vec![arm(&quote!(Self), &of.fields, &quote!(at), &module)?],
            Data::Enum(of) => {
                let serde = Serde::of(&input.attrs)?;
                let arms = of.variants.iter().map(|v| arm_of(v, &serde, &module));
                arms.collect::<Result<_>>()?
            }
            Data::Union(_) => return Err(Error::new_spanned(name, "a union is no part")),
        };
        Ok(quote!(match self { #(#arms)* }))
    };
    let (shared, mutable) = (
        walk(format_ident!("shared"))?,
        walk(format_ident!("mutable"))?,
    );
    let check = input.attrs.iter().find(|a| a.path().is_ident("checked"));
    let check = check.map(|_| {
        quote! {
            fn check_own(&self, at: &crate::Place, checks: &mut crate::Checks) {
                self.check(&at.key, checks);
            }
        }
    });
    Ok(quote! {
        #[automatically_derived]
        #[allow(unused_variables, reason = "not every part has parts")]
        impl crate::Part for #name {
            fn parts<'a>(&'a self, at: &crate::Place, see: crate::See<'_, 'a>) {
                #shared
            }

            fn parts_mut<'a>(&'a mut self, at: &crate::Place, see: crate::SeeMut<'_, 'a>) {
                #mutable
            }

            #check
        }
    })
}

/// The arm of a variant, whose own key is its name, unless the enum has none.
fn arm_of(variant: &Variant, of_enum: &Serde, module: &Ident) -> Result<TokenStream> {
    let (ident, own) = (&variant.ident, Serde::of(&variant.attrs)?);
    if own.skip {
        return Ok(quote!(Self::#ident { .. } => {}));
    }
    let key = own.rename.unwrap_or_else(|| snake_case(&ident.to_string()));
    let at = match of_enum.untagged {
        true => quote!(at),
        false => quote!(&at.name(#key)),
    };
    arm(&quote!(Self::#ident), &variant.fields, &at, module)
}

/// The arm that shows each of some fields.
fn arm(
    path: &TokenStream,
    fields: &Fields,
    at: &TokenStream,
    module: &Ident,
) -> Result<TokenStream> {
    let (mut bound, mut shown) = (Vec::new(), Vec::new());
    for (k, field) in fields.iter().enumerate() {
        let value = Ident::new(&format!("field{k}"), Span::mixed_site());
        bound.push(match &field.ident {
            Some(ident) => quote!(#ident: #value),
            None => quote!(#value),
        });
        shown.push(show(field, &value, at, module)?);
    }
    let pattern = match fields {
        Fields::Named(_) => quote!(#path { #(#bound),* }),
        Fields::Unnamed(_) => quote!(#path(#(#bound),*)),
        Fields::Unit => quote!(#path),
    };
    Ok(quote!(#pattern => { #(#shown)* }))
}

/// How a field is shown.
fn show(field: &Field, value: &Ident, at: &TokenStream, module: &Ident) -> Result<TokenStream> {
    let serde = Serde::of(&field.attrs)?;
    let unit = field.attrs.iter().find(|a| a.path().is_ident("unit"));
    let unit = unit.map(Attribute::parse_args::<Ident>).transpose()?;
    if is_function(field) != unit.is_some() {
        let message = "functions of time have a unit, `#[unit(Metre)]`, and nothing else has";
        return Err(Error::new_spanned(field, message));
    }
    let mut place = match &field.ident {
        Some(ident) => {
            let key = serde.rename.unwrap_or_else(|| ident.to_string());
            quote!(at.name(#key))
        }
        None => quote!(at.clone()),
    };
    if let Some(unit) = unit {
        place = quote!(#place.in_unit(crate::Unit::#unit));
    }
    let walk = match serde.with {
        Some(path) => quote!(#path::#module),
        None => quote!(crate::part::#module),
    };
    Ok(match serde.skip {
        true => TokenStream::new(),
        false => quote!({ let at = #at; #walk(#value, || #place, see); }),
    })
}

/// Whether a field is a function of time, or several.
fn is_function(field: &Field) -> bool {
    let words = field.ty.to_token_stream().to_string();
    words
        .split(|c: char| !c.is_alphanumeric())
        .any(|word| word == "ProfileKey")
}

/// What `serde` is told of an enum, a variant or a field.
#[derive(Default)]
struct Serde {
    rename: Option<String>,
    with: Option<syn::Path>,
    untagged: bool,
    skip: bool,
}

impl Serde {
    fn of(attributes: &[Attribute]) -> Result<Self> {
        let mut found = Self::default();
        for attribute in attributes.iter().filter(|a| a.path().is_ident("serde")) {
            let told = Punctuated::<Meta, Token![,]>::parse_terminated;
            for meta in attribute.parse_args_with(told)? {
                let text = match &meta {
                    Meta::NameValue(of) => match &of.value {
                        Expr::Lit(ExprLit {
                            lit: Lit::Str(text),
                            ..
                        }) => Some(text),
                        _ => None,
                    },
                    _ => None,
                };
                let path = meta.path();
                let named = |name: &str| path.is_ident(name);
                match text {
                    Some(text) if named("rename") => found.rename = Some(text.value()),
                    Some(text) if named("with") => found.with = Some(text.parse()?),
                    _ => {}
                }
                found.untagged |= named("untagged");
                found.skip |= named("skip");
            }
        }
        Ok(found)
    }
}

/// The name of a variant as scenes have it.
fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}
